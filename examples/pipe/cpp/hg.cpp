// Henyey-Greenstein directions about +z.  c++ -O2 -std=c++17 hg.cpp -o hg && fogproof check --exec ./hg --spec ../hg.toml
#include <cmath>
#include "fogproof.hpp"
static bool bug = false;  // --bug: wo points back to where the light came from

struct HenyeyGreenstein {
    explicit HenyeyGreenstein(const fogproof::Parameters& p) : g(p.get("g", 0.8)) {}
    void sample(const double* u, double* row) const {  // two uniforms -> x, y, z, pdf
        const double root = (1 - g * g) / (1 - g + 2 * g * u[0]);
        const double mu = std::abs(g) > 1e-3 ? (1 + g * g - root * root) / (2 * g) : 2 * u[0] - 1;
        const double sine = std::sqrt(std::fmax(0.0, 1 - mu * mu)), phi = 2 * pi * u[1];
        row[0] = sine * std::cos(phi), row[1] = sine * std::sin(phi), row[2] = bug ? -mu : mu;
        row[3] = pdf(row);
    }
    double pdf(const double* x) const {  // per steradian
        const double s = 1 + g * g - 2 * g * x[2];
        return (1 - g * g) / (4 * pi * s * std::sqrt(s));
    }
    const double pi = 3.14159265358979323846;
    double g;
};

int main(int argc, char**) {
    bug = argc > 1;
    return fogproof::serve<HenyeyGreenstein>({"x", "x", "x", "pdf"});
}
