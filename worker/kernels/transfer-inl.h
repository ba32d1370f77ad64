// SPDX-License-Identifier: Apache-2.0
// Colour and extinction of a value, from the committed table.

#if defined(GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_
#endif

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

struct Optics {
  Floats3 color;
  Floats extinction;  ///< 1/mm
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Optics interpolated_rows(const float* rows, Ints row, Floats fraction) {
  const float* first = rows + 4 * hn::GetLane(row);
  const auto column = [&](int c) HWY_ATTR {
    return lerp(hn::Set(kFloats, first[c]), hn::Set(kFloats, first[4 + c]), fraction);
  };
  return {{column(0), column(1), column(2)}, column(3)};
}
#else
/// Rows of four floats of as many lanes as a vector has blocks of 128 bits: block b is the row of
/// lane 4b + `first`. Whole rows are one load each; gathers of single floats took four.
template <class D>
HWY_INLINE hn::Vec<D> load_rows(D d, const float* rows, const std::int32_t* row) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::LoadU(d, rows + 4 * std::ptrdiff_t(row[0]));
  } else {
    const hn::Half<D> half;
    const auto low = load_rows(half, rows, row);
    const auto high = load_rows(half, rows, row + hn::MaxLanes(D()) / 2);
    return hn::Combine(d, high, low);
  }
}

/// For lanes 4b + k: their rows and the ones after them, interpolated; still a row per block.
template <int kLane>
HWY_INLINE Floats interpolated_block(const float* rows, const std::int32_t* row, Floats fraction) {
  const Floats here = load_rows(kFloats, rows, row + kLane);
  const Floats after = load_rows(kFloats, rows + 4, row + kLane);
  return lerp(here, after, hn::Broadcast<kLane>(fraction));
}

HWY_INLINE Optics interpolated_rows(const float* rows, Ints row, Floats fraction) {
  HWY_ALIGN std::int32_t lanes[hn::MaxLanes(kInts)];
  hn::Store(row, kInts, lanes);
  const Floats r0 = interpolated_block<0>(rows, lanes, fraction);
  const Floats r1 = interpolated_block<1>(rows, lanes, fraction);
  const Floats r2 = interpolated_block<2>(rows, lanes, fraction);
  const Floats r3 = interpolated_block<3>(rows, lanes, fraction);
  // Rows to columns, inside each block of 128 bits.
  const Floats low02 = hn::InterleaveLower(kFloats, r0, r2);
  const Floats low13 = hn::InterleaveLower(kFloats, r1, r3);
  const Floats high02 = hn::InterleaveUpper(kFloats, r0, r2);
  const Floats high13 = hn::InterleaveUpper(kFloats, r1, r3);
  return {{hn::InterleaveLower(kFloats, low02, low13), hn::InterleaveUpper(kFloats, low02, low13),
           hn::InterleaveLower(kFloats, high02, high13)},
          hn::InterleaveUpper(kFloats, high02, high13)};
}
#endif

/// Between which rows a value lies.
struct TablePlace {
  Ints row;
  Floats fraction;
};
HWY_INLINE TablePlace place_in(const TransferTable& table, Floats value) {
  const Floats exact = hn::Mul(hn::Sub(value, hn::Set(kFloats, table.first_value)),
                               hn::Set(kFloats, table.rows_per_value));
  const Floats place = hn::Min(hn::Max(exact, hn::Zero(kFloats)), hn::Set(kFloats, table.last_row));
  const Ints row = hn::Min(truncated(place), hn::Set(kInts, std::int32_t(table.last_row) - 1));
  return {row, hn::Sub(place, hn::ConvertTo(kFloats, row))};
}

/// `value` must be finite.
HWY_INLINE Optics look_up(const TransferTable& table, Floats value) {
  const TablePlace place = place_in(table, value);
  return interpolated_rows(table.rows, place.row, place.fraction);
}

/// Whether `segments` may be used: they fit into the lanes of a vector.
HWY_INLINE bool fit_lanes(const TransferSegments& segments) {
  return segments.count > 0 && std::size_t(segments.count) <= hn::MaxLanes(kFloats);
}

/// Where a value lies among the segments, which are in registers: no memory is touched.
class SegmentPlace {
 public:
  /// `value` must be finite.
  HWY_INLINE SegmentPlace(const TransferSegments& segments, Floats value)
      : segments_(segments),
        index_(hn::IndicesFromVec(kFloats, segment_of(segments, value))),
        way_(hn::Sub(value, coefficient(segments.start))) {}

  /// Of a segment of full length.
  HWY_INLINE Floats opacity() const {
    const auto& c = segments_.opacity;
    const Floats high = hn::MulAdd(way_, coefficient(c[3]), coefficient(c[2]));
    const Floats linear = hn::MulAdd(way_, high, coefficient(c[1]));
    return hn::Max(hn::MulAdd(way_, linear, coefficient(c[0])), hn::Zero(kFloats));
  }
  HWY_INLINE Floats3 color() const { return {channel(0), channel(1), channel(2)}; }

 private:
  static HWY_INLINE Ints segment_of(const TransferSegments& segments, Floats value) {
#if HWY_TARGET == HWY_AVX3_DL
    if (segments.has_buckets) return segment_by_bucket(segments, value);
#endif
    Ints segment = hn::Zero(kInts);
    for (int i = 1; i < segments.count; ++i) {
      const auto behind = hn::RebindMask(kInts, hn::Ge(value, hn::Set(kFloats, segments.start[i])));
      segment = hn::Sub(segment, hn::VecFromMask(kInts, behind));
    }
    return segment;
  }
#if HWY_TARGET == HWY_AVX3_DL
  /// The segment in which the value's bucket begins, or the one after it.
  static HWY_INLINE Ints segment_by_bucket(const TransferSegments& segments, Floats value) {
    const Floats exact = hn::Mul(hn::Sub(value, hn::Set(kFloats, segments.first_bucket)),
                                 hn::Set(kFloats, segments.buckets_per_value));
    const Floats last = hn::Set(kFloats, float(TransferSegments::kBuckets - 1));
    const Ints bucket = truncated(hn::Min(hn::Max(exact, hn::Zero(kFloats)), last));
    const Ints first{_mm512_maskz_permutexvar_epi8(0x1111111111111111ULL, bucket.raw,
                                                   _mm512_loadu_si512(segments.bucket))};
    const auto index = hn::IndicesFromVec(kFloats, first);
    const Floats end = hn::TableLookupLanes(hn::LoadU(kFloats, segments.end), index);
    // The sign of the difference, not a comparison: that would take the way through a mask.
    const auto before = hn::BitCast(kUnsigned, hn::Sub(value, end));
    const Ints is_before = hn::BitCast(kInts, hn::ShiftRight<31>(before));
    return hn::Sub(hn::Add(first, hn::Set(kInts, 1)), is_before);
  }
#endif
  HWY_INLINE Floats coefficient(const float* table) const {
    return hn::TableLookupLanes(hn::LoadU(kFloats, table), index_);
  }
  HWY_INLINE Floats channel(int c) const {
    return hn::MulAdd(way_, coefficient(segments_.color[c][1]), coefficient(segments_.color[c][0]));
  }

  const TransferSegments& segments_;
  decltype(hn::IndicesFromVec(kFloats, Ints())) index_;
  Floats way_;
};

/// A column of the table alone.
HWY_INLINE Floats interpolated_column(const float* column, const TablePlace& place) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  // A row and the next one in a gather of 64 bits: half as many loads.
  constexpr hn::Repartition<std::int64_t, FloatTag> kPairs{};
  const auto* pairs = reinterpret_cast<const std::int64_t*>(column);
  const Ints offset = hn::ShiftLeft<2>(place.row);
  const hn::Half<IntTag> half;
  const auto low = hn::GatherOffset(kPairs, pairs, hn::PromoteTo(kPairs, hn::LowerHalf(offset)));
  const auto high =
      hn::GatherOffset(kPairs, pairs, hn::PromoteTo(kPairs, hn::UpperHalf(half, offset)));
  const Floats first = hn::BitCast(kFloats, low), second = hn::BitCast(kFloats, high);
  return lerp(hn::ConcatEven(kFloats, second, first), hn::ConcatOdd(kFloats, second, first),
              place.fraction);
#else
  return lerp(hn::GatherIndex(kFloats, column, place.row),
              hn::GatherIndex(kFloats, column + 1, place.row), place.fraction);
#endif
}

/// Opacity and colour of a value, which must be finite.
struct Look {
  Floats opacity;
  Floats3 color;
};

/// Of a segment of full length.
HWY_INLINE Look look_at(const TransferTable& table, Floats value) {
  if (fit_lanes(*table.segments)) {
    const SegmentPlace place(*table.segments, value);
    return {place.opacity(), place.color()};
  }
  const TablePlace place = place_in(table, value);
  return {interpolated_column(table.opacities, place),
          interpolated_rows(table.rows, place.row, place.fraction).color};
}

/// Of segments of the given lengths in steps, at most 1.
HWY_INLINE Look look_at(const TransferTable& table, Floats value, Floats steps, float step_mm) {
  Look look = look_at(table, value);
  const auto part = hn::Lt(steps, hn::Set(kFloats, 1.0F));
  if (hn::AllFalse(kFloats, part)) return look;
  const Floats extinction = interpolated_column(table.extinctions, place_in(table, value));
  const Floats depth = hn::Mul(extinction, hn::Mul(steps, hn::Set(kFloats, step_mm)));
  look.opacity = hn::IfThenElse(part, one_minus_exp(depth), look.opacity);
  return look;
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
