// Ask the oracle from C++: start `fogproof oracle -` once, write a request a line, read an answer a line.
// c++ -O2 oracle_client.cpp -o oracle_client && ./oracle_client
#include <cstdio>
#include <cstdlib>
#include <string>
#include <unistd.h>
struct Oracle {
    FILE *to, *from;
    Oracle() {
        int ask[2], tell[2];
        if (pipe(ask) || pipe(tell)) std::exit(1);
        if (fork() == 0) {
            dup2(ask[0], 0), dup2(tell[1], 1), close(ask[1]), close(tell[0]);
            execlp("fogproof", "fogproof", "oracle", "-", (char*)nullptr), _exit(127);
        }
        close(ask[0]), close(tell[1]), to = fdopen(ask[1], "w"), from = fdopen(tell[0], "r");
    }
    std::string ask(const std::string& request) {
        std::fprintf(to, "%s\n", request.c_str()), std::fflush(to);
        std::string line;
        for (int c; (c = std::getc(from)) != EOF && c != '\n';) line += char(c);
        return line;  // {"protocol": ..., "value": 0.505, "error": 3e-15, "unit": "1/m", ...} or {..., "error": {"code": ...}}
    }
};
int main() {
    std::string line = Oracle().ask(R"({"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": "inf"})");
    size_t at = line.find("\"value\": ");
    if (at == std::string::npos) return std::fputs(line.c_str(), stderr), 1;
    std::printf("%.17g\n", std::strtod(line.c_str() + at + 9, nullptr));
}
