// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/local_expansion_kernels.hpp"

#include <cmath>
#include <cstring>

namespace fdp_stereo {
namespace FDP_STEREO_ISA {
namespace {

constexpr int kLanes = kGuideChannels * kPlaneBatch;

// One sum per channel and plane, lane = channel * kPlaneBatch + plane. The compiler splits it into the registers that
// the instruction set has; every lane is its own chain of operations, so all sets give the same bits.
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float)), aligned(sizeof(float)), may_alias));
typedef float Planes __attribute__((vector_size(kPlaneBatch * sizeof(float)), aligned(sizeof(float)), may_alias));

inline Lanes& lanes(float* p) { return *reinterpret_cast<Lanes*>(p); }
inline Planes& planes(float* p) { return *reinterpret_cast<Planes*>(p); }
inline const Planes& planes(const float* p) { return *reinterpret_cast<const Planes*>(p); }

inline int lowest(int a, int b) { return a < b ? a : b; }
inline int highest(int a, int b) { return a > b ? a : b; }

struct Span {
  int begin, end;
  int size() const { return end - begin; }
};

inline Span grown(const Span& s, int by, int limit) { return {highest(s.begin - by, 0), lowest(s.end + by, limit)}; }

// Where the parts of the scratch memory lie, in floats.
struct Layout {
  int rows;          // of the two ring buffers
  int raw_width;     // px of a row of raw costs at most
  int sum_width;     // px of a row of coefficients at most
  int column_width;  // px of a row of column sums, with zeros at both ends
  std::size_t raw, column, coefficient, column2, staging, total;
  Layout(int width, int radius) {
    rows = 2 * radius + 2;
    raw_width = width + 4 * radius;
    sum_width = width + 2 * radius;
    column_width = raw_width + 2;
    raw = 0;
    column = raw + static_cast<std::size_t>(rows) * raw_width * kPlaneBatch;
    coefficient = column + static_cast<std::size_t>(column_width) * kLanes;
    column2 = coefficient + static_cast<std::size_t>(rows) * sum_width * kLanes;
    staging = column2 + static_cast<std::size_t>(sum_width + 2) * kLanes;
    total = staging + static_cast<std::size_t>(raw_width) * (kPlaneBatch + 3);
  }
};

template <typename T>
const T* volumeOf(const PlaneCostTask& task);
template <>
const std::uint8_t* volumeOf(const PlaneCostTask& task) {
  return task.volume8;
}
template <>
const std::uint16_t* volumeOf(const PlaneCostTask& task) {
  return task.volume16;
}

// Costs of plane k along row y, columns xs, into out[0 .. xs.size()).
template <typename T>
void fetchRow(const PlaneCostTask& task, int k, int y, const Span& xs, float* __restrict out, float* staging) {
  const int n = xs.size();
  float* __restrict fraction = staging;
  std::int32_t* __restrict entry = reinterpret_cast<std::int32_t*>(staging + n);
  T* pairs = reinterpret_cast<T*>(staging + 2 * n);
  const float a = task.a[k];
  const float row = task.b[k] * static_cast<float>(y) + task.c[k] - task.first;
  const float last = static_cast<float>(task.entries - 1);
  const int last_pair = highest(task.entries - 2, 0);
  for (int i = 0; i < n; ++i) {
    float f = (a * static_cast<float>(xs.begin + i) + row) * task.entries_per_px;
    f = f > 0.0F ? f : 0.0F;
    f = f < last ? f : last;
    std::int32_t e = static_cast<std::int32_t>(f);
    e = e < last_pair ? e : last_pair;
    entry[i] = e;
    fraction[i] = f - static_cast<float>(e);
  }
  const std::ptrdiff_t stride = task.stride;
  const T* pixel = volumeOf<T>(task) + (static_cast<std::ptrdiff_t>(y) * task.image_width + xs.begin) * stride;
  for (int i = 0; i < n; ++i, pixel += stride) std::memcpy(pairs + 2 * i, pixel + entry[i], 2 * sizeof(T));
  for (int i = 0; i < n; ++i) {
    const float low = static_cast<float>(pairs[2 * i]);
    const float high = static_cast<float>(pairs[2 * i + 1]);
    const float cost = (low + fraction[i] * (high - low)) * task.scale;
    out[i] = cost < task.threshold ? cost : task.threshold;
  }
}

// The same for all planes, planes innermost.
void fetchRows(const PlaneCostTask& task, int y, const Span& xs, float* __restrict out, float* __restrict staging) {
  const int n = xs.size();
  float* rest = staging + static_cast<std::ptrdiff_t>(n) * kPlaneBatch;
  for (int k = 0; k < kPlaneBatch; ++k) {
    if (task.volume8 != nullptr) {
      fetchRow<std::uint8_t>(task, k, y, xs, staging + k * n, rest);
    } else {
      fetchRow<std::uint16_t>(task, k, y, xs, staging + k * n, rest);
    }
  }
  static_assert(kPlaneBatch == 4, "the interleaving below is written for four planes");
  const float* __restrict s0 = staging;
  const float* __restrict s1 = staging + n;
  const float* __restrict s2 = staging + 2 * n;
  const float* __restrict s3 = staging + 3 * n;
  for (int i = 0; i < n; ++i) {
    out[4 * i] = s0[i];
    out[4 * i + 1] = s1[i];
    out[4 * i + 2] = s2[i];
    out[4 * i + 3] = s3[i];
  }
}

// column += sign * (1, r, g, b) x raw, along one row.
template <int kSign>
void addProducts(const float* raw, const float* guide, int n, float* column) {
  for (int i = 0; i < n; ++i) {
    const Planes p = planes(raw + i * kPlaneBatch);
    const float* g = guide + i * kGuideChannels;
    float* sum = column + i * kLanes;
    for (int channel = 0; channel < kGuideChannels; ++channel) {
      const Planes product = p * g[channel];
      planes(sum + channel * kPlaneBatch) += kSign > 0 ? product : -product;
    }
  }
}

template <int kSign>
void addRow(const float* row, int n, float* column) {
  for (int i = 0; i < n; ++i) {
    const Lanes& value = *reinterpret_cast<const Lanes*>(row + i * kLanes);
    lanes(column + i * kLanes) += kSign > 0 ? value : -value;
  }
}

// (offset, slopes) of the local linear models from the sums s: out = inverse * s.
inline void solveModel(const float* m, const Lanes& sums, float* out) {
  float stored[kLanes];
  std::memcpy(stored, &sums, sizeof(stored));
  const Planes s0 = planes(stored);
  const Planes s1 = planes(stored + kPlaneBatch);
  const Planes s2 = planes(stored + 2 * kPlaneBatch);
  const Planes s3 = planes(stored + 3 * kPlaneBatch);
  planes(out) = s0 * m[0] + s1 * m[1] + s2 * m[2] + s3 * m[3];
  planes(out + kPlaneBatch) = s0 * m[1] + s1 * m[4] + s2 * m[5] + s3 * m[6];
  planes(out + 2 * kPlaneBatch) = s0 * m[2] + s1 * m[5] + s2 * m[7] + s3 * m[8];
  planes(out + 3 * kPlaneBatch) = s0 * m[3] + s1 * m[6] + s2 * m[8] + s3 * m[9];
}

// The two box filters of a task run down its rows in step, each with a running sum per column.
class CostFilter {
 public:
  explicit CostFilter(const PlaneCostTask& task)
      : task_(task),
        layout_(task.width, task.radius),
        target_x_{task.x0, task.x0 + task.width},
        target_y_{task.y0, task.y0 + task.height},
        sum_x_(grown(target_x_, task.radius, task.image_width)),
        sum_y_(grown(target_y_, task.radius, task.image_height)),
        raw_x_(grown(sum_x_, task.radius, task.image_width)),
        raw_y_(grown(sum_y_, task.radius, task.image_height)),
        next_raw_(raw_y_.begin),
        next_sum_(sum_y_.begin) {
    const std::size_t clear = static_cast<std::size_t>(layout_.column_width) * kLanes;
    std::memset(task.scratch + layout_.column, 0, clear * sizeof(float));
    const std::size_t clear2 = static_cast<std::size_t>(layout_.sum_width + 2) * kLanes;
    std::memset(task.scratch + layout_.column2, 0, clear2 * sizeof(float));
  }

  void run() {
    for (int y = target_y_.begin; y < target_y_.end; ++y) {
      while (next_sum_ < lowest(y + task_.radius + 1, sum_y_.end)) addCoefficientRow();
      const int old = y - task_.radius - 1;
      if (old >= sum_y_.begin) addRow<-1>(coefficientRow(old), sum_x_.size(), column2At(sum_x_.begin));
      writeRow(y);
    }
  }

 private:
  // Column sums start radius + 1 px left of the first window's centre, so that windows need no test of the border.
  float* columnAt(int x) {
    return task_.scratch + layout_.column + static_cast<std::ptrdiff_t>(x - sum_x_.begin + task_.radius + 1) * kLanes;
  }
  float* column2At(int x) {
    return task_.scratch + layout_.column2 +
           static_cast<std::ptrdiff_t>(x - target_x_.begin + task_.radius + 1) * kLanes;
  }
  float* rawRow(int y) {
    return task_.scratch + layout_.raw +
           static_cast<std::ptrdiff_t>(y % layout_.rows) * layout_.raw_width * kPlaneBatch;
  }
  float* coefficientRow(int y) {
    return task_.scratch + layout_.coefficient +
           static_cast<std::ptrdiff_t>(y % layout_.rows) * layout_.sum_width * kLanes;
  }
  std::ptrdiff_t pixel(int x, int y) const { return static_cast<std::ptrdiff_t>(y) * task_.image_width + x; }

  void addRawRow() {
    const int y = next_raw_++;
    fetchRows(task_, y, raw_x_, rawRow(y), task_.scratch + layout_.staging);
    addProducts<1>(rawRow(y), task_.guide + pixel(raw_x_.begin, y) * kGuideChannels, raw_x_.size(),
                   columnAt(raw_x_.begin));
  }

  void addCoefficientRow() {
    const int y = next_sum_++;
    while (next_raw_ < lowest(y + task_.radius + 1, raw_y_.end)) addRawRow();
    const int old = y - task_.radius - 1;
    if (old >= raw_y_.begin) {
      addProducts<-1>(rawRow(old), task_.guide + pixel(raw_x_.begin, old) * kGuideChannels, raw_x_.size(),
                      columnAt(raw_x_.begin));
    }
    float* out = coefficientRow(y);
    const float* inverse = task_.inverse + pixel(sum_x_.begin, y) * kSymmetricEntries;
    Lanes sums = {};
    for (int x = sum_x_.begin - task_.radius; x < sum_x_.begin + task_.radius; ++x) sums += lanes(columnAt(x));
    for (int x = sum_x_.begin; x < sum_x_.end; ++x, out += kLanes, inverse += kSymmetricEntries) {
      sums += lanes(columnAt(x + task_.radius));
      solveModel(inverse, sums, out);
      sums -= lanes(columnAt(x - task_.radius));
    }
    addRow<1>(coefficientRow(y), sum_x_.size(), column2At(sum_x_.begin));
  }

  void writeRow(int y) {
    const int rows = lowest(y + task_.radius + 1, task_.image_height) - highest(y - task_.radius, 0);
    const float* g = task_.guide + pixel(target_x_.begin, y) * kGuideChannels;
    Lanes sums = {};
    for (int x = target_x_.begin - task_.radius; x < target_x_.begin + task_.radius; ++x) sums += lanes(column2At(x));
    for (int x = target_x_.begin; x < target_x_.end; ++x, g += kGuideChannels) {
      sums += lanes(column2At(x + task_.radius));
      float s[kLanes];
      std::memcpy(s, &sums, sizeof(s));
      sums -= lanes(column2At(x - task_.radius));
      const int columns = lowest(x + task_.radius + 1, task_.image_width) - highest(x - task_.radius, 0);
      const Planes mean = (planes(s) + planes(s + kPlaneBatch) * g[1] + planes(s + 2 * kPlaneBatch) * g[2] +
                           planes(s + 3 * kPlaneBatch) * g[3]) *
                          (1.0F / static_cast<float>(rows * columns));
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(y - target_y_.begin) * task_.width + x - target_x_.begin;
      for (int k = 0; k < kPlaneBatch; ++k) task_.out[k][at] = mean[k];
    }
  }

  const PlaneCostTask& task_;
  const Layout layout_;
  const Span target_x_, target_y_, sum_x_, sum_y_, raw_x_, raw_y_;
  int next_raw_, next_sum_;
};

std::size_t planeCostScratch(int width, int radius) { return Layout(width, radius).total; }

void planeCosts(const PlaneCostTask& task) { CostFilter(task).run(); }

inline float truncated(float value, float limit) { return value < limit ? value : limit; }

constexpr int kStepX[kPairDirections] = {1, 1, 0, -1};
constexpr int kStepY[kPairDirections] = {0, 1, 1, 1};

inline std::ptrdiff_t stepOf(const MoveTask& task, int direction) {
  return static_cast<std::ptrdiff_t>(kStepY[direction]) * task.pitch + kStepX[direction];
}
// Rows are multiples of kMoveLanes long: told to the compiler, so that loops along them have no rest.
inline int pitchOf(const MoveTask& task) { return task.pitch / kMoveLanes * kMoveLanes; }

void keepCosts(const MoveTask& task) {
  const int n = pitchOf(task);
  for (int d = 0; d < kPairDirections; ++d) {
    const float sx = static_cast<float>(kStepX[d]);
    const float sy = static_cast<float>(kStepY[d]);
    for (int y = 0; y < task.rows; ++y) {
      const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * n;
      const std::ptrdiff_t other = row + stepOf(task, d);
      const float v = static_cast<float>(task.y0 + y);
      const float* weight = task.weights[d] + row;
      float* __restrict out = task.keep[d] + row;
      for (int x = 0; x < n; ++x) {
        const float da = task.a[row + x] - task.a[other + x];
        const float db = task.b[row + x] - task.b[other + x];
        const float dc = task.c[row + x] - task.c[other + x];
        const float at_p = da * static_cast<float>(task.x0 + x) + db * v + dc;
        const float at_q = at_p + da * sx + db * sy;
        out[x] = weight[x] * truncated(std::fabs(at_p) + std::fabs(at_q), task.threshold);
      }
    }
  }
  float* __restrict sum = task.keep_sum;
  for (std::ptrdiff_t p = 0; p < static_cast<std::ptrdiff_t>(task.rows) * n; ++p) {
    float pairs = 0.0F;
    for (int d = 0; d < kPairDirections; ++d) pairs += task.keep[d][p] + task.keep[d][p - stepOf(task, d)];
    sum[p] = task.cost[p] + pairs;
  }
}

// Difference planes, new minus current, at their own pixels.
void planeDifferences(const MoveTask& task) {
  const int n = pitchOf(task), x0 = task.x0;
  const float plane_a = task.plane_a, plane_b = task.plane_b, plane_c = task.plane_c;
  const float *a = task.a, *b = task.b, *c = task.c;
  for (int y = 0; y < task.rows; ++y) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * n;
    const float v = static_cast<float>(task.y0 + y);
    float* __restrict da = task.da + row;
    float* __restrict db = task.db + row;
    float* __restrict dd = task.dd + row;
#pragma omp simd
    for (int x = 0; x < n; ++x) {
      const float slope_x = plane_a - a[row + x];
      const float slope_y = plane_b - b[row + x];
      da[x] = slope_x;
      db[x] = slope_y;
      dd[x] = slope_x * static_cast<float>(x0 + x) + slope_y * v + (plane_c - c[row + x]);
    }
  }
}

// Edges of one direction, and what the pairs add to the terminals of their first and second pixels.
void pairTerms(const MoveTask& task, int d) {
  const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(task.rows) * pitchOf(task);
  const std::ptrdiff_t step = stepOf(task, d);
  const float sx = static_cast<float>(kStepX[d]);
  const float sy = static_cast<float>(kStepY[d]);
  const float threshold = task.threshold;
  const float *da = task.da, *db = task.db, *dd = task.dd;
  const float* weight = task.weights[d];
  const float* keep = task.keep[d];
  float* __restrict edge = task.edge[d];
  float* __restrict terminal = task.terminal;
  float* __restrict share = task.share;
#pragma omp simd
  for (std::ptrdiff_t p = 0; p < size; ++p) {
    const std::ptrdiff_t q = p + step;
    const float new_p = std::fabs(dd[q]) + std::fabs(dd[q] - da[q] * sx - db[q] * sy);  // p new, q keeps
    const float new_q = std::fabs(dd[p]) + std::fabs(dd[p] + da[p] * sx + db[p] * sy);  // p keeps, q new
    const float b_cost = weight[p] * truncated(new_p, threshold);
    const float c_cost = weight[p] * truncated(new_q, threshold);
    const float rest = 0.5F * (b_cost + c_cost - keep[p]);
    edge[p] = rest > 0.0F ? rest : 0.0F;
    terminal[p] += b_cost - keep[p] - edge[p];
    share[p] = c_cost - keep[p] - edge[p];
  }
  for (std::ptrdiff_t p = 0; p < size; ++p) terminal[p] += share[p - step];
}

void moveTerms(const MoveTask& task) {
  const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(task.rows) * pitchOf(task);
  planeDifferences(task);
  std::memset(task.terminal, 0, static_cast<std::size_t>(size) * sizeof(float));
  const float* proposed = task.proposed;
  for (int y = 1; y < task.rows - 1; ++y, proposed += task.width) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * task.pitch + 1;
    for (int x = 0; x < task.width; ++x) task.terminal[row + x] = proposed[x] - task.cost[row + x];
  }
  for (int d = 0; d < kPairDirections; ++d) pairTerms(task, d);
  float* __restrict total = task.total;
  for (std::ptrdiff_t p = 0; p < size; ++p) {
    float edges = 0.0F;
    for (int d = 0; d < kPairDirections; ++d) edges += task.edge[d][p] + task.edge[d][p - stepOf(task, d)];
    total[p] = task.terminal[p] + edges;
  }
}

// Vectors of one register: comparisons of longer ones are taken apart into single numbers.
#if defined(__AVX2__)
constexpr int kEntries = 8;
#else
constexpr int kEntries = 4;
#endif
typedef float Entries __attribute__((vector_size(kEntries * sizeof(float))));
typedef std::int32_t Flags __attribute__((vector_size(kEntries * sizeof(std::int32_t))));

// Copies, which compile to moves that need no alignment: through a reference clang takes the vector as aligned.
inline Entries entries(const float* p) {
  Entries values;
  std::memcpy(&values, p, sizeof(values));
  return values;
}
inline void setEntries(float* p, const Entries& values) { std::memcpy(p, &values, sizeof(values)); }

// The edges of a MoveTask, held apart so that loops need not read the pointers anew.
struct Edges {
  const float* e0;
  const float* e1;
  const float* e2;
  const float* e3;
  std::ptrdiff_t pitch;
  explicit Edges(const MoveTask& task)
      : e0(task.edge[0]), e1(task.edge[1]), e2(task.edge[2]), e3(task.edge[3]), pitch(task.pitch) {}

  // Sums of the edges from the entries p .. p + kEntries - 1 to those of their neighbours that are 1.
  Entries to(const float* x, std::ptrdiff_t p) const {
    const std::ptrdiff_t n = pitch;
    return entries(e0 + p) * entries(x + p + 1) + entries(e0 + p - 1) * entries(x + p - 1) +
           entries(e1 + p) * entries(x + p + n + 1) + entries(e1 + p - n - 1) * entries(x + p - n - 1) +
           entries(e2 + p) * entries(x + p + n) + entries(e2 + p - n) * entries(x + p - n) +
           entries(e3 + p) * entries(x + p + n - 1) + entries(e3 + p - n + 1) * entries(x + p - n + 1);
  }
};

// Sets every entry of row y to what pays for it while its neighbours are as x says. True if one changed.
bool improveRow(const MoveTask& task, const Edges& edges, int y, float* x) {
  const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * task.pitch;
  Flags changed = {};
  for (std::ptrdiff_t p = row; p < row + task.pitch; p += kEntries) {
    const Entries gain = entries(task.total + p) - 2.0F * edges.to(x, p);
    const Entries value = gain < 0.0F ? entries(task.inner + p) : Entries{};
    changed |= value != entries(x + p);
    setEntries(x + p, value);
  }
  int any = 0;
  for (int k = 0; k < kEntries; ++k) any |= changed[k];
  return any != 0;
}

void improve(const MoveTask& task, float* x) {
  std::memset(task.stale, 1, static_cast<std::size_t>(task.rows));
  const Edges edges(task);
  bool any = true;
  for (int pass = 0; any; ++pass) {
    any = false;
    for (int k = 1; k < task.rows - 1; ++k) {
      const int y = pass % 2 == 0 ? k : task.rows - 1 - k;
      if (task.stale[y] == 0) continue;
      task.stale[y] = 0;
      if (!improveRow(task, edges, y, x)) continue;
      any = true;
      task.stale[y - 1] = task.stale[y] = task.stale[y + 1] = 1;
    }
  }
}

double moveChange(const MoveTask& task) {
  const Edges edges(task);
  double sums[kMoveLanes] = {};
  const std::ptrdiff_t end = static_cast<std::ptrdiff_t>(task.rows - 1) * task.pitch;
  for (std::ptrdiff_t p = task.pitch; p < end; p += kMoveLanes) {
    float parts[kMoveLanes];
    for (int k = 0; k < kMoveLanes; k += kEntries) {
      const Entries x = entries(task.lower + p + k);
      setEntries(parts + k, x * (entries(task.total + p + k) - edges.to(task.lower, p + k)));
    }
    for (int k = 0; k < kMoveLanes; ++k) sums[k] += static_cast<double>(parts[k]);
  }
  double sum = 0.0;
  for (const double part : sums) sum += part;
  return sum;
}

}  // namespace

const LocalExpansionKernels& localExpansionKernels() {
  static constexpr LocalExpansionKernels kKernels = {planeCostScratch, planeCosts, keepCosts,
                                                     moveTerms,        improve,    moveChange};
  return kKernels;
}

}  // namespace FDP_STEREO_ISA
}  // namespace fdp_stereo
