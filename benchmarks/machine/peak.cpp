// What one core can do: multiply-adds in registers, and bytes written to memory that does not fit any cache.
//
// Prints Gflop/s and GB/s, each the best of several tries, by the processor's time.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#if defined(__AVX512F__)
constexpr int WIDTH = 8;
#elif defined(__AVX__)
constexpr int WIDTH = 4;
#else
constexpr int WIDTH = 2;
#endif
typedef double Vector __attribute__((vector_size(8 * WIDTH)));

constexpr int CHAINS = 12;  // more than latency (4 cycles) times two units, fewer than there are registers
constexpr long STEPS = 20000000;

double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

// Twelve sums, each a variable of its own: an array would be kept in memory.
#define EACH(X) X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7) X(8) X(9) X(10) X(11)

double gigaflops(volatile double* kept) {
  Vector factor, term;
  for (int w = 0; w < WIDTH; ++w) factor[w] = 0.999999, term[w] = 1e-6;
#define START(i) Vector sum##i = term * double(i);
#define STEP(i) sum##i = sum##i * factor + term;
#define KEEP(i) asm volatile("" : "+v"(sum##i));  // really computed, in a register
  EACH(START)
  const double start = processor_seconds();
  for (long step = 0; step < STEPS; ++step) {
    EACH(STEP)
    EACH(KEEP)
  }
  const double taken = processor_seconds() - start;
  *kept = sum0[0];
  return 2e-9 * WIDTH * CHAINS * STEPS / taken;
}

double gigabytes(std::vector<double>& array, double value) {
  const double start = processor_seconds();
  std::fill(array.begin(), array.end(), value);
  asm volatile("" : : "r"(array.data()) : "memory");
  return 8e-9 * array.size() / (processor_seconds() - start);
}

int main() {
  volatile double kept = 0;
  std::vector<double> array(32 << 20, 0.0);  // 256 MiB
  double flops = 0, bytes = 0;
  for (int i = 0; i < 5; ++i) {
    flops = std::max(flops, gigaflops(&kept));
    bytes = std::max(bytes, gigabytes(array, i));
  }
  std::printf("%.3f %.3f\n", flops, bytes);
}
