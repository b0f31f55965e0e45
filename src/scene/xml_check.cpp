#include <algorithm>
#include <charconv>
#include <cstdio>

#include "scene/xml_tree.h"
#include "sutura/text.h"

namespace sutura {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool is_name_start(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == ':' ||
         static_cast<unsigned char>(c) >= 128;
}
bool is_name_char(char c) {
  return is_name_start(c) || (c >= '0' && c <= '9') || c == '-' || c == '.';
}

std::string odd_byte(char c) {
  const auto value = static_cast<unsigned char>(c);
  char hex[8];
  std::snprintf(hex, sizeof hex, "0x%02x", value);
  return value < 0x20
             ? std::string("the control character ") + hex + ", which XML does not allow"
             : std::string("the byte ") + hex + " is not UTF-8; save the file as UTF-8 text";
}

/// Bytes of the character that begins the text, or 0: no UTF-8, or a control character, which XML
/// does not allow.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 || is_blank(text[0]) ? 1 : 0;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  unsigned code = first & (0xFFu >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0u) != 0x80u) return 0;
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  const bool is_shortest = size == 2 || code >= (size == 3 ? 0x800u : 0x10000u);
  const bool is_character = code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
  return is_shortest && is_character ? size : 0;
}

/// One pass over the text, never back, so that hostile input costs no more than its length.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool document();
  int line() const { return error_line_; }
  const std::string& message() const { return message_; }

 private:
  struct Open {
    std::string_view name;
    int line;
  };

  bool at_end() const { return i_ >= text_.size(); }
  char here() const { return text_[i_]; }
  bool starts(std::string_view what) const { return text_.substr(i_).starts_with(what); }
  bool fail(std::string message, int line = 0) {
    message_ = std::move(message);
    error_line_ = line > 0 ? line : line_;
    return false;
  }
  void advance(std::size_t n = 1) {
    for (; n > 0 && i_ < text_.size(); --n, ++i_)
      if (text_[i_] == '\n') ++line_;
  }
  void skip_blanks() {
    while (!at_end() && is_blank(here())) advance();
  }
  std::string_view name();
  bool skip_past(std::string_view end, const char* what);
  bool entity();
  bool start_tag();
  bool end_tag();
  bool attribute(std::vector<std::string_view>& seen, std::string_view element);
  bool text_until_tag();

  std::string_view text_;
  std::size_t i_ = 0;
  int line_ = 1;
  int error_line_ = 0;
  std::string message_;
  std::vector<Open> open_;
  int elements_ = 0;
  bool root_closed_ = false;
};

std::string_view Scanner::name() {
  const std::size_t begin = i_;
  if (!at_end() && is_name_start(here()))
    while (!at_end() && is_name_char(here())) ++i_;
  return text_.substr(begin, i_ - begin);
}

bool Scanner::skip_past(std::string_view end, const char* what) {
  const int begin = line_;
  const std::size_t found = text_.find(end, i_);
  if (found == std::string_view::npos)
    return fail(std::string("the file ends inside ") + what + " that begins here", begin);
  advance(found + end.size() - i_);
  return true;
}

bool Scanner::entity() {
  constexpr std::size_t longest = 12;
  const std::string_view window = text_.substr(i_, longest);
  const std::size_t end = window.find(';');
  const std::string_view body =
      end == std::string_view::npos ? std::string_view() : window.substr(1, end - 1);
  bool known = body == "lt" || body == "gt" || body == "amp" || body == "quot" || body == "apos";
  if (body.starts_with("#")) {
    const bool hex = body.starts_with("#x");
    const std::string_view digits = body.substr(hex ? 2 : 1);
    unsigned code = 0;
    const auto [last, status] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, hex ? 16 : 10);
    known = status == std::errc{} && last == digits.data() + digits.size() && code >= 32 &&
            code < 0xD800;
  }
  if (!known) return fail("'&' begins no known entity; write '&amp;' for the sign itself");
  advance(end + 1);
  return true;
}

bool Scanner::attribute(std::vector<std::string_view>& seen, std::string_view element) {
  const std::string where = " in <" + shortened(element) + ">";
  const std::string_view attribute = name();
  if (attribute.empty()) {
    const bool printable = here() > ' ' && here() <= '~';
    return fail((printable ? "'" + std::string(1, here()) + "'" : std::string("an odd byte")) +
                " where an attribute or '>' was expected" + where);
  }
  const std::string quoted = "attribute '" + shortened(attribute) + "'";
  if (std::find(seen.begin(), seen.end(), attribute) != seen.end())
    return fail(quoted + " is given twice" + where);
  seen.push_back(attribute);
  if (seen.size() > static_cast<std::size_t>(XmlLimits::attributes))
    return fail("more than " + std::to_string(XmlLimits::attributes) + " attributes" + where);
  skip_blanks();
  if (at_end() || here() != '=') return fail(quoted + " has no value" + where);
  advance();
  skip_blanks();
  if (at_end() || (here() != '"' && here() != '\''))
    return fail("the value of " + quoted + " is not in quotes" + where);
  const char quote = here();
  const int begin = line_;
  advance();
  while (!at_end() && here() != quote) {
    if (here() == '<')
      return fail("the quotes of " + quoted + " are not closed (or write '&lt;' for '<')", begin);
    if (here() == '&') {
      if (!entity()) return false;
    } else {
      advance();
    }
  }
  if (at_end()) return fail("the file ends inside the value of " + quoted, begin);
  advance();
  if (!at_end() && is_name_start(here())) return fail("a blank is missing after " + quoted + where);
  return true;
}

bool Scanner::start_tag() {
  const int begin = line_;
  advance();
  const std::string_view element = name();
  if (element.empty()) return fail("'<' is not followed by the name of an element");
  if (root_closed_)
    return fail("a second root element <" + shortened(element) + ">; a scene has one");
  if (++elements_ > XmlLimits::elements)
    return fail("more than " + std::to_string(XmlLimits::elements) + " elements");
  if (open_.size() >= static_cast<std::size_t>(XmlLimits::depth))
    return fail("elements are nested deeper than " + std::to_string(XmlLimits::depth));
  std::vector<std::string_view> seen;
  while (true) {
    skip_blanks();
    if (at_end())
      return fail("the file ends inside the tag <" + shortened(element) + "> that begins here",
                  begin);
    if (starts("/>")) {
      advance(2);
      root_closed_ = open_.empty();
      return true;
    }
    if (here() == '>') {
      advance();
      open_.push_back({element, begin});
      return true;
    }
    if (!attribute(seen, element)) return false;
  }
}

bool Scanner::end_tag() {
  advance(2);
  const std::string_view element = name();
  if (open_.empty())
    return fail("</" + shortened(element) + "> closes an element that was never opened");
  if (element != open_.back().name)
    return fail("</" + shortened(element) + "> where </" + shortened(open_.back().name) +
                "> was expected, opened at line " + std::to_string(open_.back().line));
  skip_blanks();
  if (at_end() || here() != '>') return fail("</" + shortened(element) + " is not followed by '>'");
  advance();
  open_.pop_back();
  root_closed_ = open_.empty();
  return true;
}

bool Scanner::text_until_tag() {
  while (!at_end() && here() != '<') {
    if (here() == '&') {
      if (!entity()) return false;
      continue;
    }
    if (open_.empty() && !is_blank(here()))
      return fail(elements_ == 0 ? "this is not XML: text before the first element"
                                 : "text after the end of the root element");
    advance();
  }
  return true;
}

bool Scanner::document() {
  if (const std::size_t nul = text_.find('\0'); nul != std::string_view::npos) {
    advance(nul);
    return fail("a NUL byte: this is not UTF-8 text");
  }
  for (std::size_t i = 0, size; i < text_.size(); i += size) {
    size = character(text_.substr(i));
    if (size > 0) continue;
    advance(i);
    return fail(odd_byte(text_[i]));
  }
  if (text_.starts_with("\xEF\xBB\xBF")) i_ = 3;  // byte order mark
  if (text_.find_first_not_of(" \t\r\n", i_) == std::string_view::npos)
    return fail("the file is empty; expected <sutura version=\"1\">");
  while (!at_end()) {
    if (!text_until_tag()) return false;
    if (at_end()) break;
    bool good;
    if (starts("<!--"))
      good = skip_past("-->", "a comment");
    else if (starts("<?"))
      good = skip_past("?>", "a processing instruction");
    else if (starts("<![CDATA["))
      good = fail("CDATA has no place in a scene");
    else if (starts("<!"))
      good = fail("a document type has no place in a scene");
    else if (starts("</"))
      good = end_tag();
    else
      good = start_tag();
    if (!good) return false;
  }
  if (!open_.empty())
    return fail("the file ends before </" + shortened(open_.back().name) + ">", open_.back().line);
  if (elements_ == 0) return fail("the file has no element; expected <sutura version=\"1\">");
  return true;
}

}  // namespace

bool check_xml_text(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  if (text.size() > XmlLimits::bytes) {
    diagnostics.error({file, 0}, "",
                      "the file has " + std::to_string(text.size()) + " bytes; at most " +
                          std::to_string(XmlLimits::bytes) + " are read");
    return false;
  }
  Scanner scanner(text);
  if (scanner.document()) return true;
  diagnostics.error({file, scanner.line()}, "", scanner.message());
  return false;
}

}  // namespace sutura
