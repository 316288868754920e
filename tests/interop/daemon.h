/* daemon.h - a connection to a running daemon: sends requests, reads framed replies. */
#pragma once

#include "tests/oracle/cgal_delaunay.h"

#include <stdexcept>
#include <string>
#include <vector>

/* Ends a job: a reply differs, or the connection breaks. */
struct failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct reply {
    std::string status;
    std::vector<std::string> lines;
};

class daemon_link
{
  public:
    explicit daemon_link(int port);
    ~daemon_link();
    daemon_link(const daemon_link &) = delete;
    daemon_link &operator=(const daemon_link &) = delete;

    void send(const std::string &bytes);
    reply receive(); /* skips comments */
    reply ask(const std::string &line);
    /* A request about places (PROTOCOL.md, LOCATEB), x and y of each; the words of its reply. */
    oracle_row ask_places(const std::string &line, const std::vector<double> &xy);

  private:
    std::string line();
    void fill();
    int fd;
    std::string buffer;
    size_t at = 0;
};

/* The value of key=... in a status line, "" if the key is missing. */
std::string value_of(const std::string &status, const std::string &key);

/* The fewest digits that read back to the same double. */
std::string number_text(double v);

/* Whether the word reads as v and has no more digits than it needs. */
bool is_number(const std::string &word, double v);

std::string row_text(const oracle_row &row);
