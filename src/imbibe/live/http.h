// What the server answers to an HTTP request, as a pure function of its text: GET of one of the page's files, or the
// upgrade to the one WebSocket. Nothing a client writes becomes a path: names are looked up in a list made at the start.
//
// Who may ask: `Host` must be a name of this server (so that a foreign page cannot reach it by rebinding its own name);
// an `Origin`, when given, must be that same host; with a token, the WebSocket needs ?token=.
// Tested in tests/live/wire_test.cpp.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace imbibe::live {

inline constexpr std::size_t longest_request = 8192;

struct PageFile {
  std::string type;  // media type
  std::string body;
};

struct Site {
  std::map<std::string, PageFile, std::less<>> files;  // by path, "/index.html"
  std::vector<std::string> hosts;                      // allowed values of Host, "127.0.0.1:8080"
  bool any_host = false;                               // listening on all addresses: the token guards
  std::string token;                                   // "" = none needed
};

struct HttpAnswer {
  std::string head_and_body;
  bool upgrade = false;  // the connection speaks WebSocket from here on
};

// `request`: everything up to and with the empty line.
HttpAnswer answer(const Site& site, std::string_view request);

// "" when the file type is none that a page is made of.
std::string media_type(std::string_view file_name);

// True in a time that does not depend on where the texts differ.
bool same_secret(std::string_view a, std::string_view b);

}  // namespace imbibe::live
