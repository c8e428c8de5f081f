// What the compiled peers share: the chain and the configurations that they are given, LAPACK, questions and answers.
//
// A peer's process prints its name and the questions that it can answer, then for each line that it reads one line:
// microseconds per configuration for "time QUESTION" (the processor's time: what else the machine does is not counted);
// for "numbers QUESTION" the Yoshikawa index, or the singular values, of the first configurations.
#pragma once
#include <dlfcn.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

constexpr int CHECKED = 256;
constexpr int ROWS = 6, MOST = 64;

// A chain as Pinocchio holds it: for each joint its type and its placement on the link before, then the tool's.
struct Chain {
  struct Step {
    std::string type;
    double axis[3], rotation[9], translation[3];  // rotation by rows
  };
  std::vector<Step> joints;
  Step tool;
};

inline Chain read_chain(const char* path) {
  std::ifstream file(path);
  Chain chain;
  size_t count = 0;
  file >> count;
  chain.joints.resize(count);
  auto read = [&file](Chain::Step& step) {
    file >> step.type;
    for (double& x : step.axis) file >> x;
    for (double& x : step.rotation) file >> x;
    for (double& x : step.translation) file >> x;
  };
  for (auto& joint : chain.joints) read(joint);
  read(chain.tool);
  if (!file) throw std::runtime_error("chain file");
  return chain;
}

inline std::vector<double> read_configurations(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::vector<double> q(file.tellg() / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(q.data()), q.size() * sizeof(double));
  return q;
}

// LAPACK of NumPy's own OpenBLAS (64-bit integers), which is what np.linalg calls.
struct Lapack {
  using Gesdd = void (*)(const char*, const int64_t*, const int64_t*, double*, const int64_t*, double*, double*,
                         const int64_t*, double*, const int64_t*, double*, const int64_t*, int64_t*, int64_t*);
  using Getrf = void (*)(const int64_t*, const int64_t*, double*, const int64_t*, int64_t*, int64_t*);
  using Potrf = void (*)(const char*, const int64_t*, double*, const int64_t*, int64_t*);
  Gesdd gesdd;
  Getrf getrf;
  Potrf potrf;
  explicit Lapack(const char* path) {
    void* library = dlopen(path, RTLD_NOW);
    if (library == nullptr) throw std::runtime_error(dlerror());
    gesdd = reinterpret_cast<Gesdd>(dlsym(library, "scipy_dgesdd_64_"));
    getrf = reinterpret_cast<Getrf>(dlsym(library, "scipy_dgetrf_64_"));
    potrf = reinterpret_cast<Potrf>(dlsym(library, "scipy_dpotrf_64_"));
    if (gesdd == nullptr || getrf == nullptr || potrf == nullptr) throw std::runtime_error("no LAPACK in this library");
  }

  // Singular values, descending, of a column-major 6 x n matrix, which is overwritten.
  void singular_values(double* matrix, int64_t n, double* values) const {
    int64_t rows = ROWS, one = 1, room = 4096, info = 0, integers[8 * ROWS];
    double work[4096], none[1];
    gesdd("N", &rows, &n, matrix, &rows, values, none, &one, none, &one, work, &room, integers, &info);
  }

  // |det J| of a square J by LU, else the product of the diagonal of the Cholesky factor of J J^T.
  double yoshikawa(const double* matrix, int64_t n) const {
    int64_t rows = ROWS, info = 0, pivots[ROWS];
    double square[ROWS * ROWS], product = 1;
    if (n == ROWS) {
      std::copy(matrix, matrix + ROWS * ROWS, square);
      getrf(&rows, &rows, square, &rows, pivots, &info);
    } else {
      gram(matrix, n, square);
      potrf("L", &rows, square, &rows, &info);
    }
    for (int i = 0; i < ROWS; ++i) product *= square[i * ROWS + i];
    return std::abs(product);
  }

  static void gram(const double* matrix, int64_t n, double* square) {
    for (int j = 0; j < ROWS; ++j)
      for (int i = 0; i < ROWS; ++i) {
        double sum = 0;
        for (int64_t k = 0; k < n; ++k) sum += matrix[k * ROWS + i] * matrix[k * ROWS + j];
        square[j * ROWS + i] = sum;
      }
  }
};

inline int least(int n) { return std::min(ROWS, n); }

// A question: what is computed of configuration q; the numbers that are checked are written to `out`.
using Answer = std::function<int(const double* q, double* out)>;

inline double product(const double* values, int count) {
  double all = 1;
  for (int i = 0; i < count; ++i) all *= values[i];
  return all;
}

inline double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

template <class Compute>
std::string timed(const std::vector<double>& q, int n, Compute compute) {
  double out[MOST];
  volatile double kept = 0;
  const size_t count = q.size() / n;
  const double start = processor_seconds();
  for (size_t i = 0; i < count; ++i) {
    compute(&q[i * n], out);
    kept = out[0];
  }
  const double taken = processor_seconds() - start;
  (void)kept;
  std::ostringstream text;
  text << 1e6 * taken / count;
  return text.str();
}

// The questions of a peer, by name. Each is a template instance of its own loop: no call through a pointer inside.
struct Questions {
  struct Way {
    std::string question;
    std::function<std::string()> time;
    Answer answer;
  };
  const std::vector<double>& q;
  int n;
  std::vector<Way> ways;

  template <class Compute>
  void add(const std::string& question, Compute compute) {
    ways.push_back({question, [this, compute] { return timed(q, n, compute); }, compute});
  }

  void serve(const std::string& name) const {
    std::cout << name;
    for (const auto& way : ways) std::cout << '\t' << way.question;
    std::cout << std::endl;
    std::string line;
    while (std::getline(std::cin, line)) {
      for (const auto& way : ways) {
        if (line == "time " + way.question) std::cout << way.time() << std::endl;
        if (line == "numbers " + way.question) std::cout << numbers(way) << std::endl;
      }
    }
  }

  std::string numbers(const Way& way) const {
    std::ostringstream text;
    text.precision(17);
    double out[MOST];
    for (size_t i = 0; i < std::min<size_t>(CHECKED, q.size() / n); ++i) {
      const int count = way.answer(&q[i * n], out);
      for (int k = 0; k < count; ++k) text << out[k] << ' ';
    }
    return text.str();
  }
};
