// A renderer's sampler as fogproof sees it: Henyey-Greenstein directions about +z, from two uniforms each, g the mean cosine.
// Plain C functions over arrays are all that another language needs; x is (n, 3), row by row.
#include <cmath>
#include <cstddef>

namespace {
const double pi = 3.14159265358979323846;
const double g = 0.8;

double henyey_greenstein(double mu) {  // per steradian
    return (1 - g * g) / (4 * pi * std::pow(1 + g * g - 2 * g * mu, 1.5));
}
}  // namespace

extern "C" void sample(std::size_t n, const double *u, double *x, double *pdf) {
    for (std::size_t i = 0; i < n; ++i) {
        const double root = (1 - g * g) / (1 - g + 2 * g * u[2 * i]);
        double mu = (1 + g * g - root * root) / (2 * g);
#ifdef FLIPPED  // the mistake that is made most often: wo points back to where the light came from
        mu = -mu;
#endif
        const double sine = std::sqrt(std::fmax(0.0, 1 - mu * mu)), phi = 2 * pi * u[2 * i + 1];
        x[3 * i] = sine * std::cos(phi);
        x[3 * i + 1] = sine * std::sin(phi);
        x[3 * i + 2] = mu;
        pdf[i] = henyey_greenstein(mu);
    }
}

extern "C" void density(std::size_t n, const double *x, double *pdf) {
    for (std::size_t i = 0; i < n; ++i) pdf[i] = henyey_greenstein(x[3 * i + 2]);
}
