// WIF drafts: what is read must be a whole draft, and read the same twice.
#include "fuzz.h"
#include "imbibe/fabric/wif.h"

using namespace imbibe;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::text_of(data, size);
  fuzz::reads([&] {
    const WifFile wif = parse_wif(text, "fuzz.wif");
    const auto ends = static_cast<std::size_t>(wif.draft.ends), picks = static_cast<std::size_t>(wif.draft.picks);
    IMBIBE_ASSERT(ends > 0 && picks > 0 && wif.draft.warp_up.size() == ends * picks);
    for (const WifThreads* threads : {&wif.warp, &wif.weft}) {
      const auto n = static_cast<std::size_t>(threads->threads);
      IMBIBE_ASSERT(threads->spacing.empty() || threads->spacing.size() == n);
      IMBIBE_ASSERT(threads->thickness.empty() || threads->thickness.size() == n);
      IMBIBE_ASSERT(threads->colour.empty() || threads->colour.size() == n);
      for (const Real length : threads->spacing) IMBIBE_ASSERT(std::isfinite(length) && length > 0);
    }
    if (ends * picks < 10000) weave_facts(wif.draft);
  });
  return 0;
}
