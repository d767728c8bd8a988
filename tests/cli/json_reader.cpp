#include "json_reader.hpp"

#include <cctype>

namespace pingvox::test {
namespace {

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  bool object(const std::string& path, FlatJson& out) {
    if (!take('{')) return false;
    if (take('}')) return true;
    do {
      std::string key;
      if (!string(&key) || !take(':') || !value(path.empty() ? key : path + "." + key, &out)) return false;
    } while (take(','));
    return take('}');
  }

  bool is_at_end() const { return at_ == text_.size(); }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }

  bool take(char c) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  bool word(std::string_view w) {
    if (text_.substr(at_, w.size()) != w) return false;
    at_ += w.size();
    return true;
  }

  /// At a backslash: goes to the last character of what it begins.
  bool escape() {
    ++at_;
    const char escaped = at_ < text_.size() ? text_[at_] : '\0';
    if (std::string_view("\"\\/bfnrtu").find(escaped) == std::string_view::npos) return false;
    if (escaped != 'u') return true;
    for (int i = 0; i < 4; ++i) {
      ++at_;
      if (at_ >= text_.size() || !std::isxdigit(static_cast<unsigned char>(text_[at_]))) return false;
    }
    return true;
  }

  bool string(std::string* content) {
    if (!take('"')) return false;
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) return false;
      if (text_[at_] == '\\' && !escape()) return false;
      if (content) *content += text_[at_];
    }
    return take('"');
  }

  bool digits() {
    const std::size_t start = at_;
    while (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_ > start;
  }

  bool number() {
    word("-");
    if (!word("0") && !digits()) return false;
    if (word(".") && !digits()) return false;
    if (word("e") || word("E")) {
      if (!word("+")) word("-");
      return digits();
    }
    return true;
  }

  bool array() {
    if (take(']')) return true;
    do {
      if (!value("", nullptr)) return false;
    } while (take(','));
    return take(']');
  }

  /// A value; objects are entered, everything else is put into `out` as it is spelt.
  bool value(const std::string& path, FlatJson* out) {
    skip_blanks();
    if (at_ >= text_.size()) return false;
    const std::size_t start = at_;
    FlatJson inner;
    if (text_[at_] == '{') return object(path, out ? *out : inner);
    const bool good = text_[at_] == '"'   ? string(nullptr)
                      : text_[at_] == '[' ? (++at_, array())
                                          : word("null") || word("true") || word("false") || number();
    if (!good) return false;
    return !out || out->emplace(path, text_.substr(start, at_ - start)).second;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<FlatJson> flat_json(std::string_view text) {
  if (!text.ends_with('\n')) return std::nullopt;
  text.remove_suffix(1);
  Reader reader(text);
  FlatJson out;
  if (!reader.object("", out) || !reader.is_at_end()) return std::nullopt;
  return out;
}

}  // namespace pingvox::test
