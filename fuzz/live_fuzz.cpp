// Whatever a client of `imbibe live` can send: the first byte chooses a request, frames or a message.
#include "fuzz.h"
#include "imbibe/live/http.h"
#include "imbibe/live/protocol.h"
#include "imbibe/live/websocket.h"

using namespace imbibe;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 3 == 0) {
    live::Site site;
    site.files["/index.html"] = {"text/html", "page"};
    site.hosts = {"127.0.0.1:80"};
    site.token = "secret";
    const live::HttpAnswer answer = live::answer(site, text);
    IMBIBE_ASSERT(answer.head_and_body.starts_with("HTTP/1.1 "));
    IMBIBE_ASSERT(!answer.upgrade || text.find("token=secret") != std::string::npos);
  } else if (data[0] % 3 == 1) {
    live::MessageReader reader(1000);
    live::MessageReader::Message message;
    for (std::size_t i = 0; i < text.size(); i += 7) {
      reader.feed(std::string_view(text).substr(i, 7));
      while (reader.next(message)) IMBIBE_ASSERT(message.payload.size() <= 1000);
    }
  } else {
    const live::Message message = live::parse_message(text);
    IMBIBE_ASSERT(!message.problem.empty() || message.body.index() != 0);
  }
  return 0;
}
