#include "sim/network/psse.hpp"
#include "sim/network/psse_text.hpp"

namespace swingbank::sim {
namespace {

using psse::quote;
using psse::shortest;

/// The angle in degrees that reads back as `radians`.
std::string degrees(double radians) { return shortest(radians, psse::kDegrees); }

class RawWriter {
 public:
  explicit RawWriter(const Network& network) : n_(network) {}
  std::string text() {
    header();
    buses();
    loads();
    shunts();
    generators();
    lines();
    transformers();
    for (const char* name : {"area", "two-terminal dc line", "VSC dc line", "impedance correction",
                             "multi-terminal dc line", "multi-section line", "zone", "inter-area transfer",
                             "owner", "FACTS device", "switched shunt", "GNE device", "induction machine"})
      end(name);
    out_ += "Q\n";
    return out_;
  }

 private:
  void row(std::initializer_list<std::string> fields) {
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

  void header() {
    row({"0", shortest(n_.base_mva), "33", "0", "0", shortest(n_.frequency)});
    const auto cut = n_.title.find('\n');
    out_ +=
        n_.title.substr(0, cut) + "\n" + (cut == std::string::npos ? "" : n_.title.substr(cut + 1)) + "\n";
  }
  void buses() {
    for (const Bus& b : n_.buses)
      row({std::to_string(b.number), quote(b.name), shortest(b.kv), std::to_string(static_cast<int>(b.type)),
           "1", "1", "1", shortest(b.vm), degrees(b.va), "1.1", "0.9", "1.1", "0.9"});
    end("bus");
  }
  void loads() {
    for (const Load& l : n_.loads)
      row({number(l.bus), quote(l.id), "1", "1", "1", mw(l.power.real()), mw(l.power.imag()),
           mw(l.current.real()), mw(l.current.imag()), mw(l.admittance.real()), mw(0.0 - l.admittance.imag()),
           "1", "1", "0"});
    end("load");
  }
  void shunts() {
    for (const Shunt& s : n_.shunts)
      row({number(s.bus), quote(s.id), "1", mw(s.admittance.real()), mw(s.admittance.imag())});
    end("fixed shunt");
  }
  void generators() {
    for (const Generator& g : n_.generators)
      row({number(g.bus),
           quote(g.id),
           mw(g.p),
           mw(g.q),
           mw(g.q_max),
           mw(g.q_min),
           shortest(g.vset),
           "0",
           shortest(g.mva),
           shortest(g.zr),
           shortest(g.zx),
           "0",
           "0",
           "1",
           yes(g.in_service),
           "100",
           "9999",
           "-9999",
           "1",
           "1"});
    end("generator");
  }
  void lines() {
    for (const Branch& b : n_.branches)
      if (!b.transformer)
        row({number(b.from), number(b.to), quote(b.circuit), shortest(b.r), shortest(b.x), shortest(b.b), "0",
             "0", "0", shortest(b.shunt_from.real()), shortest(b.shunt_from.imag()),
             shortest(b.shunt_to.real()), shortest(b.shunt_to.imag()), yes(b.in_service), "1", "0", "1",
             "1"});
    end("branch");
  }
  void transformers() {
    for (const Branch& b : n_.branches) {
      if (!b.transformer) continue;
      row({number(b.from), number(b.to), "0", quote(b.circuit), "1", "1", "1", shortest(b.shunt_from.real()),
           shortest(b.shunt_from.imag()), "2", quote(""), yes(b.in_service), "1", "1"});
      row({shortest(b.r), shortest(b.x), shortest(n_.base_mva)});
      row({shortest(b.tap), "0", degrees(b.shift), "0", "0", "0", "0", "0", "1.1", "0.9", "1.1", "0.9", "33",
           "0", "0", "0", "0"});
      row({"1", "0"});
    }
    end("transformer");
  }

  const Network& n_;
  std::string out_;
};

void check(const Network& n, const std::string& file) {
  Problems problems;
  for (const Branch& b : n.branches) {
    const std::string where =
        file + ", branch " + std::to_string(n.buses[static_cast<std::size_t>(b.from)].number) + "-" +
        std::to_string(n.buses[static_cast<std::size_t>(b.to)].number) + " circuit " + b.circuit;
    if (!b.transformer && (b.tap != 1.0 || b.shift != 0.0))
      problems.add("a tap or phase shift on a line", where,
                   "the branch section of a .raw has no field for it", "mark the branch as a transformer");
    if (b.transformer && (b.b != 0.0 || b.shunt_to != Complex{}))
      problems.add("charging or a far-end shunt on a transformer", where,
                   "the transformer section of a .raw has no field for it",
                   "enter it as a fixed shunt at the bus");
  }
  problems.raise();
}

}  // namespace

void write_raw(const Network& network, const std::filesystem::path& file) {
  check(network, file.string());
  psse::write_whole(file, RawWriter(network).text());
}

}  // namespace swingbank::sim
