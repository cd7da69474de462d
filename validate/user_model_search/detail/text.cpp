#include "validate/user_model_search/detail/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace swingbank::validate::user_model_search {
namespace {

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}
std::string quantity(double value, const std::string& unit) {
  return unit == "-" ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} {}", value, unit);
}
std::string value_words(const UserModelParameter& p, const std::vector<fit::FittedParameter>& fitted) {
  const auto f = std::ranges::find(fitted, p.name, &fit::FittedParameter::name);
  std::string text = quantity(p.value, p.unit);
  if (f != fitted.end() && std::isfinite(f->low) && std::isfinite(f->high))
    text += fmt::format(" ({:.4g} to {:.4g})", f->low, f->high);
  return text;
}

}  // namespace

std::string user_model_name(const UserModelCandidate& user_model) {
  std::string name = user_model.kind == fit::InputKind::torque ? "TORQUE" : "FIELD";
  std::string rest =
      user_model.family + " " + (user_model.signal.starts_with("time ") ? "triggered" : user_model.signal);
  bool gap = true;
  for (const char c : rest) {
    if (!std::isalnum(static_cast<unsigned char>(c))) {
      gap = true;
      continue;
    }
    if (gap) name += '_';
    gap = false;
    name += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return name;
}

std::string user_model_toml(const UserModelCandidate& user_model, const std::string& source) {
  std::string text = fmt::format(
      "name = \"{}\"\ntitle = {}\nsource = {}\noutput = \"{}\"\naction = \"add\"\nvalue = {}\n\n{}\n",
      user_model_name(user_model),
      in_quotes(fmt::format("{} model of {}: {}", user_model.family, user_model.signal,
                            user_model_words(user_model))),
      in_quotes(source), user_model.kind == fit::InputKind::torque ? "Tm" : "Efd",
      in_quotes(user_model.value), user_model.body);
  if (!user_model.requirements.empty())
    text.insert(text.find("value = "), "require = [" + user_model.requirements + "]\n");
  text += "[parameters]\n";
  for (const auto& p : user_model.parameters)
    text += fmt::format(
        "{} = {{ unit = \"{}\", default = {:.17g}, low = {:.17g}, high = {:.17g},{} meaning = {} }}\n",
        p.name, p.unit, p.value, std::min(p.low, p.value), std::max(p.high, p.value),
        p.gain ? " null_value = 0.0," : "", in_quotes(p.meaning));
  return text;
}

std::string user_model_words(const UserModelCandidate& user_model,
                             const std::vector<fit::FittedParameter>& fitted) {
  std::string text = user_model.words;
  for (const auto& p : user_model.parameters) {
    const std::string place = "{" + p.name + "}";
    for (auto at = text.find(place); at != std::string::npos; at = text.find(place))
      text.replace(at, place.size(), value_words(p, fitted));
  }
  return fmt::format("a {} {}{}", user_model.kind == fit::InputKind::torque ? "torque" : "field voltage",
                     text.starts_with("a ") || text.starts_with("an ") ? "in the form of " : "of ", text);
}

}  // namespace swingbank::validate::user_model_search
