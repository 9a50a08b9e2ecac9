#include "imbibe/live/http.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "imbibe/live/websocket.h"

namespace imbibe::live {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

struct Request {
  std::string_view method, path, query;
  std::vector<std::pair<std::string, std::string_view>> headers;
  // Empty when it is missing or given twice.
  std::optional<std::string_view> header(std::string_view name) const {
    std::optional<std::string_view> found;
    for (const auto& [key, value] : headers) {
      if (key != name) continue;
      if (found) return std::nullopt;
      found = value;
    }
    return found;
  }
};

std::optional<Request> parse(std::string_view text) {
  Request r;
  bool first = true;
  while (!text.empty()) {
    const std::size_t end = text.find("\r\n");
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 2);
    if (line.empty()) return first ? std::nullopt : std::optional(r);
    if (first) {
      const std::size_t a = line.find(' '), b = line.rfind(' ');
      if (a == std::string_view::npos || b <= a || line.substr(b + 1) != "HTTP/1.1") return std::nullopt;
      r.method = line.substr(0, a), r.path = line.substr(a + 1, b - a - 1);
      if (const std::size_t mark = r.path.find('?'); mark != std::string_view::npos)
        r.query = r.path.substr(mark + 1), r.path = r.path.substr(0, mark);
      first = false;
      continue;
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || colon == 0) return std::nullopt;
    r.headers.emplace_back(lower(line.substr(0, colon)), trimmed(line.substr(colon + 1)));
  }
  return std::nullopt;
}

// The page may load nothing from elsewhere and may not be put into a frame of another page.
constexpr const char* safe_headers =
    "Content-Security-Policy: default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; "
    "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n"
    "Cache-Control: no-store\r\nConnection: close\r\n";

HttpAnswer reply(const char* status, std::string_view type, std::string_view body, bool with_body = true) {
  return {fmt::format("HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{}\r\n{}", status, type, body.size(),
                      safe_headers, with_body ? body : std::string_view{}),
          false};
}

HttpAnswer refuse(const char* status, std::string_view why) {
  return reply(status, "text/plain; charset=utf-8", std::string(why) + "\n");
}

bool host_allowed(const Site& site, std::string_view host) {
  return site.any_host || std::find(site.hosts.begin(), site.hosts.end(), lower(host)) != site.hosts.end();
}

std::string_view query_value(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    if (part.size() > name.size() && part.starts_with(name) && part[name.size()] == '=')
      return part.substr(name.size() + 1);
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return {};
}

HttpAnswer upgrade(const Site& site, const Request& request) {
  const auto key = request.header("sec-websocket-key");
  if (lower(request.header("upgrade").value_or("")) != "websocket" ||
      lower(request.header("connection").value_or("")).find("upgrade") == std::string::npos ||
      request.header("sec-websocket-version").value_or("") != "13" || !key || key->size() != 24)
    return refuse("400 Bad Request", "this address speaks WebSocket (version 13) only");
  if (!site.token.empty() && !same_secret(query_value(request.query, "token"), site.token))
    return refuse("403 Forbidden", "the token is missing or wrong; it is in the address that the program printed");
  return {fmt::format("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                      "Sec-WebSocket-Accept: {}\r\n\r\n",
                      accept_key(*key)),
          true};
}

}  // namespace

bool same_secret(std::string_view a, std::string_view b) {
  unsigned char differ = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    differ = static_cast<unsigned char>(differ | (static_cast<unsigned char>(a[i]) ^
                                                  static_cast<unsigned char>(b.empty() ? 0 : b[i % b.size()])));
  return differ == 0;
}

std::string media_type(std::string_view file_name) {
  const auto ends = [&](const char* end) { return file_name.ends_with(end); };
  if (ends(".html")) return "text/html; charset=utf-8";
  if (ends(".js")) return "text/javascript; charset=utf-8";
  if (ends(".css")) return "text/css; charset=utf-8";
  if (ends(".svg")) return "image/svg+xml";
  if (ends(".png")) return "image/png";
  if (ends(".woff2")) return "font/woff2";
  return "";
}

HttpAnswer answer(const Site& site, std::string_view text) {
  const std::optional<Request> request = parse(text);
  if (!request) return refuse("400 Bad Request", "not a request of HTTP/1.1");
  const auto host = request->header("host");
  if (!host || !host_allowed(site, *host)) return refuse("403 Forbidden", "this server does not go by that name");
  if (const auto origin = request->header("origin")) {
    if (*origin != "http://" + std::string(*host) && *origin != "https://" + std::string(*host))
      return refuse("403 Forbidden", "pages of other origins may not use this server");
  } else {
    for (const auto& header : request->headers)
      if (header.first == "origin") return refuse("403 Forbidden", "more than one origin");
  }
  if (request->method != "GET" && request->method != "HEAD") {
    return refuse("405 Method Not Allowed", "only GET");
  }
  if (request->path == "/live") return upgrade(site, *request);
  const auto file = site.files.find(request->path == "/" ? std::string_view("/index.html") : request->path);
  if (file == site.files.end()) return refuse("404 Not Found", "there is no such page");
  return reply("200 OK", file->second.type, file->second.body, request->method == "GET");
}

}  // namespace imbibe::live
