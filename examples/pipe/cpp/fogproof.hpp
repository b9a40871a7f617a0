// Let fogproof judge a C++ sampler or estimator over a pipe: one header, C++17. The protocol is docs/pipe.md.
//
//   struct MySampler {
//       explicit MySampler(const fogproof::Parameters& p) : g(p.get("g", 0.8)) {}
//       void sample(const double* u, double* row) const;   // one row of uniforms -> the columns that are announced below
//       double pdf(const double* x) const;                  // optional: the density at any point
//       void eval(const double* x, double* value) const;    // optional: what weights are for
//       double g;
//   };
//   int main() { return fogproof::serve<MySampler>({"x", "x", "x", "pdf"}); }
//
// One that draws its own numbers has void sample(std::mt19937_64& rng, double* row); so has an estimator, with columns {"value"}.
// fogproof::serve<MySampler, float> exchanges single precision: then `const float*` stands above for `const double*`.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace fogproof {

// What stands in the line of a request: {"fogproof": 1, "request": "sample", "n": 4096, "columns": 2, "seed": 0, "parameters": {"g": 0.8}}
class Parameters {
  public:
    explicit Parameters(std::string text) : text_(std::move(text)) {}
    double get(const std::string& name, double otherwise) const {
        const char* at = find(name);
        return at ? std::strtod(at, nullptr) : otherwise;
    }
    std::uint64_t whole(const std::string& name) const {
        const char* at = find(name);
        return at ? std::strtoull(at, nullptr, 10) : 0;
    }
    bool asks(const char* request) const { return text_.find(std::string("\"request\": \"") + request + '"') != std::string::npos; }

  private:
    const char* find(const std::string& name) const {
        const std::string key = '"' + name + "\": ";
        const std::size_t at = text_.find(key);
        return at == std::string::npos ? nullptr : text_.c_str() + at + key.size();
    }
    std::string text_;
};

namespace detail {
template <class S, class T, class = void> struct has_pdf : std::false_type {};
template <class S, class T>
struct has_pdf<S, T, std::void_t<decltype(std::declval<const S&>().pdf(std::declval<const T*>()))>> : std::true_type {};

template <class S, class T, class = void> struct has_eval : std::false_type {};
template <class S, class T>
struct has_eval<S, T, std::void_t<decltype(std::declval<const S&>().eval(std::declval<const T*>(), std::declval<T*>()))>>
    : std::true_type {};

template <class S, class T, class = void> struct takes_uniforms : std::false_type {};
template <class S, class T>
struct takes_uniforms<S, T, std::void_t<decltype(std::declval<const S&>().sample(std::declval<const T*>(), std::declval<T*>()))>>
    : std::true_type {};

inline bool line(std::string& text) {
    text.clear();
    for (int c; (c = std::getchar()) != EOF;) {
        if (c == '\n') return true;
        text += char(c);
    }
    return false;
}

inline std::string quoted(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "\"" : ", \"") + word + '"';
    return text;
}
}  // namespace detail

// Answer requests until the input ends; returns what main should return.
template <class S, class T = double>
int serve(std::initializer_list<const char*> columns) {
    static_assert(std::is_same<T, double>::value || std::is_same<T, float>::value, "float or double");
    const std::uint16_t one = 1;
    if (*reinterpret_cast<const unsigned char*>(&one) != 1) return std::fputs("this machine is big-endian\n", stderr), 1;
    const std::size_t width = columns.size();
    const std::size_t weights = std::count_if(columns.begin(), columns.end(), [](const char* c) { return !std::strcmp(c, "weight"); });
    std::vector<std::string> answers;
    if (detail::has_pdf<S, T>::value) answers.push_back("pdf");
    if (detail::has_eval<S, T>::value) answers.push_back("eval");
    std::printf("{\"fogproof\": 1, \"type\": \"%s\", \"columns\": [%s], \"answers\": [%s]}\n", sizeof(T) == 8 ? "float64" : "float32",
                detail::quoted({columns.begin(), columns.end()}).c_str(), detail::quoted(answers).c_str());
    std::fflush(stdout);
    std::string request;
    std::vector<T> in, out;
    while (detail::line(request)) {
        const Parameters parameters(request);
        const std::size_t n = parameters.whole("n"), k = parameters.whole("columns");
        in.resize(std::max(in.size(), n * k));  // never smaller: what grows again is filled with zeros first
        if (std::fread(in.data(), sizeof(T), n * k, stdin) != n * k) return 1;
        const S subject(parameters);
        std::size_t per_row = 1;
        if (parameters.asks("pdf")) {
            out.resize(std::max(out.size(), n));
            if constexpr (detail::has_pdf<S, T>::value)
                for (std::size_t i = 0; i < n; ++i) out[i] = subject.pdf(&in[i * k]);
        } else if (parameters.asks("eval")) {
            per_row = std::max<std::size_t>(weights, 1), out.resize(std::max(out.size(), n * per_row));
            if constexpr (detail::has_eval<S, T>::value)
                for (std::size_t i = 0; i < n; ++i) subject.eval(&in[i * k], &out[i * per_row]);
        } else {
            per_row = width, out.resize(std::max(out.size(), n * width));
            if constexpr (detail::takes_uniforms<S, T>::value) {
                for (std::size_t i = 0; i < n; ++i) subject.sample(&in[i * k], &out[i * width]);
            } else {
                std::mt19937_64 rng(parameters.whole("seed"));
                for (std::size_t i = 0; i < n; ++i) subject.sample(rng, &out[i * width]);
            }
        }
        std::printf("{\"n\": %zu}\n", n);
        std::fwrite(out.data(), sizeof(T), n * per_row, stdout);
        std::fflush(stdout);
    }
    return 0;
}

}  // namespace fogproof
