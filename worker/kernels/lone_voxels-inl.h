// SPDX-License-Identifier: Apache-2.0
// Voxels lane by lane, from where they lie: for rays too far apart to share a window. What a lane
// gets does not depend on the others.

#if defined(GOLDTHREAD_WORKER_KERNELS_LONE_VOXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_LONE_VOXELS_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_LONE_VOXELS_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_LONE_VOXELS_INL_H_
#endif

#include <cstring>

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/ray_packet-inl.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
using ByteTag = UnsignedTag;  // four bytes in the one lane
#else
using ByteTag = hn::Repartition<std::uint8_t, FloatTag>;
#endif
using Bytes = hn::Vec<ByteTag>;
constexpr ByteTag kBytes{};

struct Ints3 {
  Ints x, y, z;
};

/// A bit for each lane, to go through those that are set.
HWY_INLINE std::uint32_t bits_of(FloatMask lanes) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, lanes, bytes);
  std::uint32_t bits;
  std::memcpy(&bits, bytes, sizeof(bits));
  return bits;
}

/// Where each lane's cell lies, in stored coordinates: voxel + 1.
struct LonePlaces {
  HWY_ALIGN std::int32_t x[kLanes], y[kLanes], z[kLanes];

  HWY_INLINE explicit LonePlaces(const Ints3& at) {
    const Ints one = hn::Set(kInts, 1);
    hn::Store(hn::Add(at.x, one), kInts, x);
    hn::Store(hn::Add(at.y, one), kInts, y);
    hn::Store(hn::Add(at.z, one), kInts, z);
  }
};

#if HWY_TARGET == HWY_AVX3_DL

/// Up to four columns, 2×2, in which a lane's voxels lie.
struct LoneColumns {
  HWY_ALIGN std::int64_t front[kLanes];   ///< where the first voxel's slice begins
  HWY_ALIGN std::int64_t right[kLanes];   ///< from its column to that of the last voxel along x
  HWY_ALIGN std::int64_t behind[kLanes];  ///< the same along y
  HWY_ALIGN std::int32_t inside[kLanes];  ///< where the first voxel lies in its slice, 4·y + x

  /// The first voxel is `before` the cell, along each axis the last one kEdge further.
  template <int kBefore, int kEdge>
  static HWY_INLINE LoneColumns of(const FieldLayout& layout, const Ints3& at) {
    LoneColumns columns;
    const Ints first = hn::Set(kInts, 1 - kBefore), three = hn::Set(kInts, 3);
    const Ints last_alone = hn::Set(kInts, 3 - kEdge);
    const Ints x = hn::Add(at.x, first), y = hn::Add(at.y, first), z = hn::Add(at.z, first);
    const Ints in_x = hn::And(x, three), in_y = hn::And(y, three);
    hn::Store(hn::Add(in_x, hn::ShiftLeft<2>(in_y)), kInts, columns.inside);
    const auto crosses_x = hn::VecFromMask(kInts, hn::Gt(in_x, last_alone));
    const auto crosses_y = hn::VecFromMask(kInts, hn::Gt(in_y, last_alone));
    GOLDTHREAD_UNROLL
    for (std::size_t i = 0; i < kLanes; i += kLanes / 2) {
      const auto column = _mm512_set1_epi64(layout.column_bytes);
      const auto row = _mm512_set1_epi64(layout.row_bytes);
      const auto along_x = _mm512_mullo_epi64(half(hn::ShiftRight<2>(x), i), column);
      const auto along_y = _mm512_mullo_epi64(half(hn::ShiftRight<2>(y), i), row);
      const auto along_z = _mm512_slli_epi64(half(z, i), 4);
      _mm512_store_si512(columns.front + i,
                         _mm512_add_epi64(along_z, _mm512_add_epi64(along_x, along_y)));
      _mm512_store_si512(columns.right + i, _mm512_and_si512(half(crosses_x, i), column));
      _mm512_store_si512(columns.behind + i, _mm512_and_si512(half(crosses_y, i), row));
    }
    return columns;
  }

 private:
  static HWY_INLINE __m512i half(Ints v, std::size_t first) {
    return _mm512_cvtepi32_epi64(first == 0 ? _mm512_castsi512_si256(v.raw)
                                            : _mm512_extracti64x4_epi64(v.raw, 1));
  }
};

/// In which byte of four columns, of which kSlices are looked at, a voxel lies.
template <int kSlices>
constexpr std::uint8_t byte_in_columns(int x, int y, int slice) {
  const int column = 2 * (y >> 2) + (x >> 2);
  return std::uint8_t((column * kSlices + slice) * 16 + (y & 3) * 4 + (x & 3));
}

/// For each place in a slice: where the eight voxels of the cell lie whose first is there.
struct CellIndices {
  alignas(64) std::uint8_t of[16][8] = {};
  constexpr CellIndices() {
    for (int place = 0; place < 16; ++place)
      for (int i = 0; i < 8; ++i)
        of[place][i] =
            byte_in_columns<2>((place & 3) + (i & 1), (place >> 2) + (i >> 1 & 1), i >> 2);
  }
};
inline constexpr CellIndices kCellIndices;

/// The same for the 32 voxels of take_around(); the first is before the cell along each axis.
struct AroundIndices {
  alignas(64) std::uint8_t of[16][32] = {};
  constexpr AroundIndices() {
    for (int place = 0; place < 16; ++place)
      for (int i = 0; i < 32; ++i) {
        const int group = i >> 2;
        const int x = group == 4 || group == 5 ? 3 * (i & 1) : 1 + (i & 1);
        const int y = group >= 6 ? 3 * (i >> 1 & 1) : 1 + (i >> 1 & 1);
        const int slice = group < 4 ? group : 1 + (group & 1);
        of[place][i] = byte_in_columns<4>((place & 3) + x, (place >> 2) + y, slice);
      }
  }
};
inline constexpr AroundIndices kAroundIndices;

/// Four bytes of each lane, two groups of them side by side; the even ones, and the odd ones.
HWY_INLINE Ints even_words(Ints a, Ints b) { return hn::ConcatEven(kInts, b, a); }
HWY_INLINE Ints odd_words(Ints a, Ints b) { return hn::ConcatOdd(kInts, b, a); }

HWY_INLINE Ints load_words(const std::uint8_t* bytes) {
  return hn::Load(kInts, reinterpret_cast<const std::int32_t*>(bytes));
}

/// Eight words of each lane to a word of all lanes each: a round takes a bit of the words' numbers.
HWY_INLINE void sort_words(const std::uint8_t (&words)[kLanes][32], Bytes (&slices)[8]) {
  Ints pairs[2][4], quads[4][2];
  GOLDTHREAD_UNROLL
  for (int i = 0; i < 4; ++i) {
    const Ints a = load_words(words[4 * i]), b = load_words(words[4 * i + 2]);
    pairs[0][i] = even_words(a, b);
    pairs[1][i] = odd_words(a, b);
  }
  GOLDTHREAD_UNROLL
  for (int i = 0; i < 4; ++i) {
    const Ints a = pairs[i & 1][2 * (i >> 1)], b = pairs[i & 1][2 * (i >> 1) + 1];
    quads[i & 1][i >> 1] = even_words(a, b);
    quads[2 + (i & 1)][i >> 1] = odd_words(a, b);
  }
  GOLDTHREAD_UNROLL
  for (int i = 0; i < 4; ++i) {
    slices[i] = hn::BitCast(kBytes, even_words(quads[i][0], quads[i][1]));
    slices[4 + i] = hn::BitCast(kBytes, odd_words(quads[i][0], quads[i][1]));
  }
}

#endif

/// The voxels of one plane as Window gives them.
class LoneVoxels {
 public:
  /// Whether this costs less than two windows.
  static constexpr bool kIsQuick = HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_SCALAR;

  HWY_INLINE explicit LoneVoxels(const FieldLayout& layout) : layout_(layout) {}

  HWY_INLINE void take_cell(const Ints3& at, FloatMask lanes, int plane, Bytes (&slices)[2]) const;
  HWY_INLINE void take_around(const Ints3& at, FloatMask lanes, int plane,
                              Bytes (&slices)[8]) const;

  /// What take_cell() will read soon, into the nearest cache.
  HWY_INLINE void fetch_ahead(const Ints3& at, FloatMask lanes, int plane) const;

 private:
#if HWY_TARGET == HWY_AVX3_DL
  static HWY_INLINE __m512i two_slices(const std::uint8_t* a, const std::uint8_t* b) {
    const auto load = [](const std::uint8_t* from) HWY_ATTR {
      return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    };
    return _mm512_inserti64x4(_mm512_castsi256_si512(load(a)), load(b), 1);
  }
#else
  HWY_INLINE std::int64_t along_x(std::int32_t x) const {
    return (x >> 2) * layout_.column_bytes + (x & 3);
  }
  HWY_INLINE std::int64_t along_y(std::int32_t y) const {
    return (y >> 2) * layout_.row_bytes + (y & 3) * 4;
  }
  HWY_INLINE const std::uint8_t* slice(const LonePlaces& places, int i, int plane) const {
    return layout_.voxels + plane * layout_.plane_bytes + std::int64_t(places.z[i]) * 16;
  }

  /// As Window::take().
  template <int kX0, int kX1, int kY0, int kY1, int kFirstZ, int kCount>
  HWY_INLINE void take(const LonePlaces& places, FloatMask lanes, int plane, Bytes* slices) const {
    HWY_ALIGN std::uint32_t words[kCount][kLanes] = {};
    for (std::uint32_t left = bits_of(lanes); left != 0; left &= left - 1) {
      const int i = __builtin_ctz(left);
      const std::uint8_t* first = slice(places, i, plane) + kFirstZ * 16;
      const std::uint8_t* row0 = first + along_y(places.y[i] + kY0);
      const std::uint8_t* row1 = first + along_y(places.y[i] + kY1);
      const std::int64_t x0 = along_x(places.x[i] + kX0), x1 = along_x(places.x[i] + kX1);
      GOLDTHREAD_UNROLL
      for (int s = 0; s < kCount; ++s)
        words[s][i] = std::uint32_t(row0[x0 + 16 * s]) | std::uint32_t(row0[x1 + 16 * s]) << 8 |
                      std::uint32_t(row1[x0 + 16 * s]) << 16 |
                      std::uint32_t(row1[x1 + 16 * s]) << 24;
    }
    for (int s = 0; s < kCount; ++s) slices[s] = hn::BitCast(kBytes, hn::Load(kUnsigned, words[s]));
  }
#endif

  const FieldLayout& layout_;
};

#if HWY_TARGET == HWY_AVX3_DL

/// Two slices of up to four columns are two registers: one permutation a lane.
HWY_INLINE void LoneVoxels::take_cell(const Ints3& at, FloatMask lanes, int plane,
                                      Bytes (&slices)[2]) const {
  const LoneColumns columns = LoneColumns::of<0, 1>(layout_, at);
  HWY_ALIGN std::uint8_t words[kLanes][8];
  const std::uint8_t* voxels = layout_.voxels + plane * layout_.plane_bytes;
  for (std::uint32_t left = bits_of(lanes); left != 0; left &= left - 1) {
    const int i = __builtin_ctz(left);
    const std::uint8_t* front = voxels + columns.front[i];
    const std::uint8_t* back = front + columns.behind[i];
    const auto index = _mm_loadu_si64(kCellIndices.of[columns.inside[i]]);
    const auto found = _mm512_permutex2var_epi8(two_slices(front, front + columns.right[i]),
                                                _mm512_castsi128_si512(index),
                                                two_slices(back, back + columns.right[i]));
    _mm_storeu_si64(words[i], _mm512_castsi512_si128(found));
  }
  const Ints low = load_words(words[0]), high = load_words(words[kLanes / 2]);
  slices[0] = hn::BitCast(kBytes, even_words(low, high));
  slices[1] = hn::BitCast(kBytes, odd_words(low, high));
}

/// Four slices of up to four columns are four registers: two permutations a lane, and which of
/// the two is the highest bit of the index, which a permutation does not look at.
HWY_INLINE void LoneVoxels::take_around(const Ints3& at, FloatMask lanes, int plane,
                                        Bytes (&slices)[8]) const {
  const LoneColumns columns = LoneColumns::of<1, 3>(layout_, at);
  HWY_ALIGN std::uint8_t words[kLanes][32];
  const std::uint8_t* voxels = layout_.voxels + plane * layout_.plane_bytes;
  const auto load = [](const std::uint8_t* from) HWY_ATTR { return _mm512_loadu_si512(from); };
  for (std::uint32_t left = bits_of(lanes); left != 0; left &= left - 1) {
    const int i = __builtin_ctz(left);
    const std::uint8_t* front = voxels + columns.front[i];
    const std::uint8_t* back = front + columns.behind[i];
    const auto index =
        _mm256_load_si256(reinterpret_cast<const __m256i*>(kAroundIndices.of[columns.inside[i]]));
    const auto wide = _mm512_castsi256_si512(index);
    const auto in_front =
        _mm512_permutex2var_epi8(load(front), wide, load(front + columns.right[i]));
    const auto in_back = _mm512_permutex2var_epi8(load(back), wide, load(back + columns.right[i]));
    const auto found =
        _mm256_mask_blend_epi8(_mm256_movepi8_mask(index), _mm512_castsi512_si256(in_front),
                               _mm512_castsi512_si256(in_back));
    _mm256_store_si256(reinterpret_cast<__m256i*>(words[i]), found);
  }
  sort_words(words, slices);
}

HWY_INLINE void LoneVoxels::fetch_ahead(const Ints3& at, FloatMask lanes, int plane) const {
  const LoneColumns columns = LoneColumns::of<0, 1>(layout_, at);
  const std::uint8_t* voxels = layout_.voxels + plane * layout_.plane_bytes;
  for (std::uint32_t left = bits_of(lanes); left != 0; left &= left - 1) {
    const int i = __builtin_ctz(left);
    const std::uint8_t* front = voxels + columns.front[i];
    const std::uint8_t* back = front + columns.behind[i];
    __builtin_prefetch(front);
    __builtin_prefetch(front + columns.right[i]);
    __builtin_prefetch(back);
    __builtin_prefetch(back + columns.right[i]);
  }
}

#else

HWY_INLINE void LoneVoxels::take_cell(const Ints3& at, FloatMask lanes, int plane,
                                      Bytes (&slices)[2]) const {
  take<0, 1, 0, 1, 0, 2>(LonePlaces(at), lanes, plane, slices);
}

HWY_INLINE void LoneVoxels::take_around(const Ints3& at, FloatMask lanes, int plane,
                                        Bytes (&slices)[8]) const {
  const LonePlaces places(at);
  take<0, 1, 0, 1, -1, 4>(places, lanes, plane, slices);
  take<-1, 2, 0, 1, 0, 2>(places, lanes, plane, slices + 4);
  take<0, 1, -1, 2, 0, 2>(places, lanes, plane, slices + 6);
}

HWY_INLINE void LoneVoxels::fetch_ahead(const Ints3& at, FloatMask lanes, int plane) const {
  const LonePlaces places(at);
  for (std::uint32_t left = bits_of(lanes); left != 0; left &= left - 1) {
    const int i = __builtin_ctz(left);
    const std::uint8_t* first = slice(places, i, plane);
    const std::uint8_t* row = first + along_y(places.y[i]);
    const std::uint8_t* next_row = first + along_y(places.y[i] + 1);
    const std::int64_t x = along_x(places.x[i]), next_x = along_x(places.x[i] + 1);
    __builtin_prefetch(row + x);
    __builtin_prefetch(row + next_x);
    __builtin_prefetch(next_row + x);
    __builtin_prefetch(next_row + next_x);
  }
}

#endif

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
