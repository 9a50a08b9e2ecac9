// The report of a verification: verify.html (one file, works offline), verify.json (the same for programs) and the
// pictures as files. Figures do not depend on the machine; `seconds` do. Tested in tests/verify/report_test.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/verify/case.h"

namespace imbibe::verify {

struct CaseOutcome {
  const Case* of = nullptr;
  CaseResult result;
  std::string failure;  // why it could not be run to its end; empty: it ran
  double seconds = 0;   // wall-clock
  bool passed() const { return failure.empty() && result.passed(); }
};

struct Verification {
  bool quick = false;
  std::string version, command;
  std::vector<CaseOutcome> outcomes;
  bool passed() const;
};

std::string json_of(const Verification& verification);
std::string html_of(const Verification& verification);
// Writes verify.html, verify.json and pictures/<case>.png into `folder`.
void write_report(const Verification& verification, const std::filesystem::path& folder);

// A figure as it is printed: enough digits to see its error.
std::string figure_text(Real value);
std::string error_text(const Check& check);
std::string tolerance_text(const Check& check);

}  // namespace imbibe::verify
