// Free paths before a surface.  c++ -O2 -std=c++17 free_path.cpp -o free_path && fogproof check --exec ./free_path --spec ../free_path.toml
#include <cmath>
#include "fogproof.hpp"
static bool bug = false;  // --bug: at the surface the density is returned, not the probability

struct FreePath {
    explicit FreePath(const fogproof::Parameters& p) : sigma_t(p.get("sigma_t", 0.5)), surface(p.get("surface", 3.0)) {}
    void sample(const double* u, double* row) const {  // one uniform -> distance, pdf, event
        const double t = -std::log1p(-u[0]) / sigma_t;
        const bool reached = t >= surface;
        row[0] = reached ? surface : t;
        row[1] = reached && !bug ? std::exp(-sigma_t * surface) : pdf(row);
        row[2] = reached ? 1 : 0;
    }
    double pdf(const double* t) const { return sigma_t * std::exp(-sigma_t * t[0]); }  // per metre
    double sigma_t, surface;
};

int main(int argc, char**) {
    bug = argc > 1;
    return fogproof::serve<FreePath>({"x", "pdf", "event"});
}
