#pragma once
// Writer of .raw files, versions 32 to 35. Reading restores all values bit by bit, except `origin`, the
// remarks, Bus::star_of, the steps of switched shunts, and values that a .raw has no field for: a tap or
// phase shift of a line, and charging or a far-end shunt of a transformer.
#include <filesystem>
#include <string>
#include <vector>

#include "base/durable.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

class RawWriter {
 public:
  RawWriter(const network::Network& network, int version) : n_(network), version_(version) {}
  std::string text() {
    header();
    buses();
    loads();
    shunts();
    generators();
    lines();
    transformers();
    for (const std::string name :
         {"area", "two-terminal dc", "vsc dc line", "impedance correction", "multi-terminal dc",
          "multi-section line", "zone", "inter-area transfer", "owner", "facts device", "switched shunt",
          "gne", "induction machine", "substation"})
      if ((name != "induction machine" || version_ >= 33) && (name != "substation" || version_ >= 34))
        end(name);
    out_ += "Q\n";
    return out_;
  }

 private:
  using Row = std::vector<std::string>;
  static std::string shortest(double value, long double scale = 1.0L) { return psse::shortest(value, scale); }
  static std::string quote(const std::string& text) { return psse::quote(text); }
  /// Returns the angle in degrees that the reader converts back to exactly `radians`.
  static std::string degrees(double radians) { return shortest(radians, psse::kDegrees); }
  void row(const Row& fields) {
    bool first = true;
    for (const auto& f : fields) {
      out_ += (first ? "" : ", ") + f;
      first = false;
    }
    out_ += "\n";
  }
  void end(const std::string& section) { out_ += "0 / end of " + section + " data\n"; }
  [[nodiscard]] std::string number(int bus) const {
    return std::to_string(n_.buses[static_cast<std::size_t>(bus)].number);
  }
  [[nodiscard]] std::string mw(double pu) const {
    return shortest(pu, static_cast<long double>(n_.base_mva));
  }
  static std::string yes(bool b) { return b ? "1" : "0"; }
  static void add(Row& row, std::initializer_list<std::string> more) { row.insert(row.end(), more); }
  /// Appends zero ratings: three up to version 33, twelve from 34.
  void ratings(Row& row) const { row.insert(row.end(), version_ >= 34 ? 12 : 3, "0"); }

  void header() {
    row({"0", shortest(n_.base_mva), std::to_string(version_), "0", "0", shortest(n_.frequency)});
    const auto cut = n_.title.find('\n');
    out_ +=
        n_.title.substr(0, cut) + "\n" + (cut == std::string::npos ? "" : n_.title.substr(cut + 1)) + "\n";
    if (version_ >= 34) end("system-wide");
  }
  void buses() {
    for (const network::Bus& b : n_.buses) {
      Row r{std::to_string(b.number),
            quote(b.name),
            shortest(b.kv),
            std::to_string(static_cast<int>(b.type)),
            std::to_string(b.area),
            std::to_string(b.zone),
            std::to_string(b.owner),
            shortest(b.vm),
            degrees(b.va)};
      if (version_ >= 33) add(r, {"1.1", "0.9", "1.1", "0.9"});
      row(r);
    }
    end("bus");
  }
  void loads() {
    for (const network::Load& l : n_.loads) {
      if (l.kind == network::LoadKind::shunt) continue;
      Row r{number(l.bus),
            quote(l.id),
            "1",
            std::to_string(l.area),
            std::to_string(l.zone),
            mw(l.power.real()),
            mw(l.power.imag()),
            mw(l.current.real()),
            mw(l.current.imag()),
            mw(l.admittance.real()),
            mw(0.0 - l.admittance.imag()),
            std::to_string(l.owner),
            "1"};
      if (version_ >= 33) add(r, {"0"});
      if (version_ >= 34) add(r, {"0", "0", "0"});
      if (version_ >= 35) add(r, {quote("")});
      row(r);
    }
    end("load");
  }
  void shunts() {
    for (const network::Shunt& s : n_.shunts)
      row({number(s.bus), quote(s.id), "1", mw(s.admittance.real()), mw(s.admittance.imag())});
    for (const network::Load& l : n_.loads)
      if (l.kind == network::LoadKind::shunt)
        row({number(l.bus), quote(l.id), "1", mw(l.admittance.real()), mw(0.0 - l.admittance.imag())});
    end("fixed shunt");
  }
  void generators() {
    for (const network::Generator& g : n_.generators) {
      Row r{number(g.bus), quote(g.id), mw(g.p),          mw(g.q),
            mw(g.q_max),   mw(g.q_min), shortest(g.vset), g.regulated < 0 ? "0" : number(g.regulated)};
      if (version_ >= 35) add(r, {"0"});
      add(r, {shortest(g.mva), shortest(g.zr), shortest(g.zx), shortest(g.rt), shortest(g.xt), "1",
              yes(g.in_service), shortest(g.share), "9999", "-9999"});
      if (version_ >= 35) add(r, {"0"});
      add(r, {"1", "1"});
      row(r);
    }
    end("generator");
  }
  void lines() {
    for (const network::Branch& b : n_.branches) {
      if (b.transformer) continue;
      Row r{number(b.from), number(b.to), quote(b.circuit), shortest(b.r), shortest(b.x), shortest(b.b)};
      if (version_ >= 34) add(r, {quote("")});
      ratings(r);
      add(r, {shortest(b.shunt_from.real()), shortest(b.shunt_from.imag()), shortest(b.shunt_to.real()),
              shortest(b.shunt_to.imag()), yes(b.in_service), "1", "0", "1", "1"});
      row(r);
    }
    end("branch");
    if (version_ >= 34) end("system switching device");
  }
  void transformers() {
    for (const network::Branch& b : n_.branches) {
      if (!b.transformer) continue;
      row({number(b.from), number(b.to), "0", quote(b.circuit), "1", "1", "1", shortest(b.shunt_from.real()),
           shortest(b.shunt_from.imag()), "2", quote(""), yes(b.in_service), "1", "1"});
      row({shortest(b.r), shortest(b.x), shortest(n_.base_mva)});
      Row r{shortest(b.tap), "0", degrees(b.shift)};
      ratings(r);
      add(r, {"0", "0"});                 // COD, CONT
      if (version_ >= 35) add(r, {"0"});  // NOD
      add(r, {"1.1", "0.9", "1.1", "0.9", "33", "0", "0", "0"});
      if (version_ >= 33) add(r, {"0"});  // CNXA
      row(r);
      row({"1", "0"});
    }
    end("transformer");
  }

  const network::Network& n_;
  int version_;
  std::string out_;
};

inline std::string raw_text(const network::Network& network, int version) {
  return RawWriter(network, version).text();
}
inline void write_raw(const network::Network& network, const std::filesystem::path& file, int version = 33) {
  write_text(file, raw_text(network, version));
}

}  // namespace swingbank::sim::formats
