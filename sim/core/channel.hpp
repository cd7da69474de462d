#pragma once
// Quantities that a simulation records for each plant. The simulator, the dataset files, the training and the
// reports share this one list.
#include <array>
#include <string_view>

namespace swingbank::sim {

/// Recorded quantity; kChannels defines each value.
enum class Channel { delta, speed, P, Q, V, theta, Efd, Ifd, Tm };
/// Name and definition of a recorded channel.
struct ChannelRecord {
  Channel channel;                       ///< value of the enumeration
  std::string_view name, unit, meaning;  ///< name in configs and files; unit; definition
};
/// Channels in per unit on the machine's own base.
inline constexpr std::array<ChannelRecord, 9> kChannels = {{
    {Channel::delta, "delta", "rad", "rotor angle in the synchronous frame"},
    {Channel::speed, "speed", "pu", "speed deviation"},
    {Channel::P, "P", "pu", "active power out of the plant"},
    {Channel::Q, "Q", "pu", "reactive power out of the plant"},
    {Channel::V, "V", "pu", "terminal voltage magnitude"},
    {Channel::theta, "theta", "rad", "terminal voltage angle in the synchronous frame; constant while V = 0"},
    {Channel::Efd, "Efd", "pu", "field voltage, 1 pu on the air-gap line"},
    {Channel::Ifd, "Ifd", "pu", "field current, 1 pu on the air-gap line"},
    {Channel::Tm, "Tm", "pu", "mechanical torque; mechanical power with the conventions of PSS/E"},
}};
inline constexpr int kChannelCount = static_cast<int>(kChannels.size());  ///< number of channels
/// Returns the definition of the channel with this name, nullptr if there is none.
constexpr const ChannelRecord* find_channel(std::string_view name) {
  for (const auto& c : kChannels)
    if (c.name == name) return &c;
  return nullptr;
}

}  // namespace swingbank::sim
