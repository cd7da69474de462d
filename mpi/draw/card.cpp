#include "mpi/draw/card.hpp"

#include <fmt/format.h>

#include "base/config.hpp"
#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/sealed_text.hpp"

namespace swingbank::mpi::draw {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

constexpr const char* kCardFormat = "swingbank-card-1";

/// Returns the files that a config names, each with its name in the config and its path.
std::vector<std::pair<std::string, fs::path>> named_files(const DatasetConfig& config) {
  Config c(config.file);
  std::vector<std::pair<std::string, fs::path>> files = {{c.require<std::string>("raw"), config.raw},
                                                         {c.require<std::string>("dyr"), config.dyr}};
  const auto user_models = c.optional<std::vector<std::string>>("user_models", {});
  for (std::size_t i = 0; i < user_models.size() && i < config.user_models.size(); ++i)
    files.emplace_back(user_models[i], config.user_models[i]);
  return files;
}

/// Returns a file as JSON. JSON requires UTF-8; any other text is read as Latin-1 and converted.
ordered_json json_of(const CardFile& f) {
  try {
    (void)nlohmann::json(f.text).dump();
    return {{"name", f.name}, {"text", f.text}};
  } catch (const nlohmann::json::type_error&) {
    std::string text;
    for (const char c : f.text) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte < 0x80) {
        text += c;
      } else {
        text += static_cast<char>(0xC0 | byte >> 6);
        text += static_cast<char>(0x80 | (byte & 0x3F));
      }
    }
    return {{"name", f.name}, {"encoding", "latin-1"}, {"text", text}};
  }
}

CardFile file_of(const nlohmann::json& j) {
  CardFile f{j.at("name"), j.at("text")};
  if (!j.contains("encoding")) return f;
  std::string bytes;
  for (std::size_t i = 0; i < f.text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(f.text[i]);
    if (byte < 0x80 || i + 1 == f.text.size())
      bytes += f.text[i];
    else
      bytes += static_cast<char>((byte & 0x03) << 6 | (static_cast<unsigned char>(f.text[++i]) & 0x3F));
  }
  f.text = bytes;
  return f;
}

ordered_json json_of(const Overrides& o) {
  ordered_json j = ordered_json::object();
  const auto put = [&](const char* name, const auto& value) {
    if (value) j[name] = *value;
  };
  put("draws", o.draws);
  put("seed", o.seed);
  put("draws_per_shard", o.draws_per_shard);
  put("faults_per_point", o.faults_per_point);
  put("shard_megabytes", o.shard_megabytes);
  put("rate", o.rate);
  if (!o.channels.empty()) j["channels"] = o.channels;
  if (o.int16) j["int16"] = true;
  return j;
}

Overrides overrides_of(const nlohmann::json& j) {
  Overrides o;
  const auto take = [&](const char* name, auto& value) {
    if (j.contains(name)) value = j.at(name).get<typename std::decay_t<decltype(value)>::value_type>();
  };
  take("draws", o.draws);
  take("seed", o.seed);
  take("draws_per_shard", o.draws_per_shard);
  take("faults_per_point", o.faults_per_point);
  take("shard_megabytes", o.shard_megabytes);
  take("rate", o.rate);
  if (j.contains("channels")) j.at("channels").get_to(o.channels);
  o.int16 = j.value("int16", false);
  return o;
}

}  // namespace

bool replace_name(std::string& text, const std::string& from, const std::string& to) {
  bool found = false;
  for (const char quote : {'"', '\''}) {
    const std::string old = quote + from + quote, fresh = quote + to + quote;
    for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += fresh.size()) {
      text.replace(at, old.size(), fresh);
      found = true;
    }
  }
  return found;
}

Card card_of(const DatasetConfig& config, const std::string& kernel,
             const std::map<std::string, std::string>& made_by) {
  Card card;
  card.name = config.file.filename().string();
  card.config = read_text(config.file);
  card.overrides = config.overrides;
  card.config_hash = config_hash(config, kernel);
  card.kernel = kernel;
  card.made_by = made_by;
  for (const auto& [written, place] : named_files(config)) {
    const std::string name = fmt::format("{}/{}", card.files.size() + 1, place.filename().string());
    if (!replace_name(card.config, written, name))
      throw InputError({"cannot write the card", config.file.string(),
                        "the config writes the file name '" + written + "' with escape sequences",
                        "write the name in quotes, without escape sequences"});
    card.files.push_back({name, read_text(place)});
  }
  return card;
}

void write_card(const fs::path& folder, const Card& card) {
  ordered_json j = {
      {"format", kCardFormat}, {"name", card.name},       {"config_hash", card.config_hash},
      {"kernel", card.kernel}, {"made_by", card.made_by}, {"overrides", json_of(card.overrides)},
      {"config", card.config}};
  j["files"] = ordered_json::array();
  for (const CardFile& f : card.files) j["files"].push_back(json_of(f));
  try {
    write_text(folder / "card.json", sealed_text(j.dump(1)));
  } catch (const nlohmann::json::type_error& e) {
    throw InputError({"a name that is not UTF-8", card.name + " or a file it names", e.what(),
                      "give the file a name in UTF-8"});
  }
}

Card read_card(const fs::path& where) {
  const fs::path file = fs::is_directory(where) ? where / "card.json" : where;
  const std::string text = read_text(file);
  constexpr const char* kRemedy = "give the card.json of a dataset, or the dataset's folder";
  if (!is_sealed(text))
    throw InputError(
        {"damaged card, or a file that is not a card", file.string(), "its checksum is wrong", kRemedy});
  try {
    const auto j = nlohmann::json::parse(text);
    if (j.at("format") != kCardFormat)
      throw std::runtime_error(std::string("its format is not ") + kCardFormat);
    Card card;
    j.at("name").get_to(card.name);
    j.at("config").get_to(card.config);
    j.at("config_hash").get_to(card.config_hash);
    j.at("kernel").get_to(card.kernel);
    j.at("made_by").get_to(card.made_by);
    card.overrides = overrides_of(j.at("overrides"));
    for (const auto& f : j.at("files")) card.files.push_back(file_of(f));
    return card;
  } catch (const std::exception& e) {
    throw InputError({"unknown card format", file.string(), e.what(), kRemedy});
  }
}

fs::path unpack(const Card& card, const fs::path& folder) {
  const auto place = [&](const std::string& name) {
    const fs::path relative = fs::path(name).lexically_normal();
    if (relative.is_absolute() || relative.empty() || *relative.begin() == "..")
      throw InputError({"a file outside the card's folder", name, "a card names files below its own folder",
                        "give a card that generate wrote"});
    return folder / relative;
  };
  for (const CardFile& f : card.files) {
    make_folder(place(f.name).parent_path());
    write_text(place(f.name), f.text);
  }
  write_text(place(card.name), card.config);
  return place(card.name);
}

}  // namespace swingbank::mpi::draw
