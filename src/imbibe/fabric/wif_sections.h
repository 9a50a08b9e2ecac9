// The text of a WIF 1.1 file taken apart: [sections] of key=value lines, with the rules of their values (whole numbers,
// numbers, booleans, rows of numbers) and all problems with their lines. What sections mean is wif.cpp.
// Sections and keys are case-insensitive; ';' begins a comment. Tested in tests/fabric/wif_test.cpp.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/core/types.h"
#include "imbibe/fabric/wif.h"

namespace imbibe::wif {

std::string lower(std::string_view text);
// The value of a number or boolean without a comment behind it.
std::string_view without_comment(std::string_view value);

struct Entry {
  std::string key;    // lower case
  std::string value;  // trimmed
  int line = 0;
};

struct Section {
  std::string name;  // as written
  int line = 0;
  std::vector<Entry> entries;
};

// A row of a numbered section: thread, pick, treadle or palette entry, with whole numbers behind it.
struct Row {
  int number = 0;
  std::vector<int> values;
  int line = 0;
};

class Reader {
 public:
  Reader(std::string_view text, std::string file);

  // By lower-case name; nullptr where the file has none.
  const Section* find(const std::string& name) const;
  const Entry* entry(const Section* section, const char* key) const;

  // section and key may be empty; line 0: the whole file.
  void problem(int line, const Section* section, const std::string& key, std::string message);
  // Throws InputError with all problems, if there are any.
  void finish();

  // Values of an entry; a wrong one is a problem and nothing is returned.
  std::optional<bool> boolean(const Section* section, const Entry& e);
  std::optional<int> whole(const Section* section, const Entry& e, std::string_view text, int least, int most);
  std::optional<Real> number(const Section* section, const Entry& e);  // 0 or more
  // Whole number under `key`, or `otherwise` where it is missing.
  int whole_or(const Section* section, const char* key, int otherwise, int least, int most);

  // All rows `n = a, b, ...` of a section with n in [1, last] and values in [least, most]; a second row for the same n
  // is a problem.
  std::vector<Row> rows(const Section* section, int last, const char* what, int least, int most, std::size_t fewest = 1,
                        std::size_t largest = static_cast<std::size_t>(largest_wif_shafts));
  std::optional<int> row_number(const Section* section, const Entry& e, int last, const char* what,
                                std::map<int, int>& seen);

 private:
  void split(std::string_view text);
  Section* open_section(std::string_view raw, int line);
  void read_entry(std::string_view raw, int line, Section& section);

  std::string file_;
  std::map<std::string, Section> sections_;
  std::vector<Problem> problems_;
  std::size_t count_ = 0;
  bool skipping_ = false;
};

}  // namespace imbibe::wif
