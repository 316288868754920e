/* daemon.cpp - a simple client of the line protocol, written from PROTOCOL.md alone. */
#include "tests/interop/daemon.h"

#include <arpa/inet.h>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sys/socket.h>
#include <unistd.h>

daemon_link::daemon_link(int port) : fd(socket(AF_INET, SOCK_STREAM, 0))
{
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    timeval patience{60, 0};
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (connect(fd, reinterpret_cast<sockaddr *>(&address), sizeof address) != 0)
        throw failure(std::string("connect: ") + std::strerror(errno));
}

daemon_link::~daemon_link()
{
    close(fd);
}

void daemon_link::send(const std::string &bytes)
{
    size_t done = 0;
    while (done < bytes.size()) {
        ssize_t n = ::send(fd, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
        if (n <= 0)
            throw failure(std::string("send: ") + std::strerror(errno));
        done += static_cast<size_t>(n);
    }
}

void daemon_link::fill()
{
    buffer.erase(0, at);
    at = 0;
    char chunk[65536];
    ssize_t n = recv(fd, chunk, sizeof chunk, 0);
    if (n <= 0)
        throw failure(n == 0 ? "the daemon closed the connection" : "no reply within 60 s");
    buffer.append(chunk, static_cast<size_t>(n));
}

std::string daemon_link::line()
{
    for (;;) {
        size_t end = buffer.find('\n', at);
        if (end != std::string::npos) {
            std::string found = buffer.substr(at, end - at);
            at = end + 1;
            return found;
        }
        fill();
    }
}

reply daemon_link::receive()
{
    reply r;
    do
        r.status = line();
    while (r.status.compare(0, 1, "#") == 0);
    size_t version = r.status.find(" version="); /* differs from run to run */
    if (version != std::string::npos && r.status.find("protocol=") == std::string::npos)
        r.status.erase(version);
    if (r.status.compare(0, 3, "OK ") != 0)
        return r;
    size_t rows = std::stoul(r.status.substr(3));
    while (r.lines.size() < rows)
        r.lines.push_back(line());
    return r;
}

reply daemon_link::ask(const std::string &line)
{
    send(line + "\n");
    return receive();
}

oracle_row daemon_link::ask_places(const std::string &line, const std::vector<double> &xy)
{
    std::string body(reinterpret_cast<const char *>(xy.data()), xy.size() * sizeof xy[0]);
    send(line + "\n" + body);
    std::string status = receive().status, bytes = value_of(status, "bytes");
    if (bytes.empty())
        throw failure(line + ": " + status);
    oracle_row words(std::stoul(bytes) / sizeof(uint32_t));
    size_t want = words.size() * sizeof words[0];
    while (buffer.size() - at < want)
        fill();
    std::memcpy(words.data(), buffer.data() + at, want);
    at += want;
    return words;
}

std::string value_of(const std::string &status, const std::string &key)
{
    size_t at = status.find(" " + key + "=");
    if (at == std::string::npos)
        return "";
    at += key.size() + 2;
    return status.substr(at, status.find(' ', at) - at);
}

std::string number_text(double v)
{
    char text[40];
    return std::string(text, std::to_chars(text, text + sizeof text, v).ptr);
}

/* The digits of a number without sign, point, exponent, and zeros at either end. */
static std::string digits_of(const std::string &word)
{
    std::string digits;
    for (char c : word.substr(0, word.find_first_of("eE")))
        if (c >= '0' && c <= '9')
            digits += c;
    size_t first = digits.find_first_not_of('0'), last = digits.find_last_not_of('0');
    return first == std::string::npos ? "" : digits.substr(first, last + 1 - first);
}

bool is_number(const std::string &word, double v)
{
    char *end;
    double read = std::strtod(word.c_str(), &end);
    char fewest[40] = {};
    std::to_chars(fewest, fewest + 39, v, std::chars_format::scientific);
    return !word.empty() && *end == '\0' && read == v && digits_of(word) == digits_of(fewest);
}

std::string row_text(const oracle_row &row)
{
    std::string text;
    for (uint32_t word : row)
        text += (text.empty() ? "" : " ") + std::to_string(word);
    return text;
}
