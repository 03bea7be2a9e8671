// The posture of a chain (chain_model.hpp) in all lanes: the sines and cosines of its angles,
// computed once per step, and the quantities that depend only on them. These are the tip's position
// and the rotations between the frames of groups.
//
// V is a lane type (lane_pack.hpp). Chain is a ChainShape, the facts about the chain that are known
// when the code is compiled (chain_shape.hpp).
#pragma once

#include "sim/dynamics/chain_shape.hpp"
#include "sim/simd/lane_math.hpp"

namespace armwright::articulated {

using lanes::Vec3;

// Rotates (x, y) by the angle with cosine c and sine s; rotate_back() rotates by its opposite.
template <class V>
ARMWRIGHT_INLINE void rotate(V c, V s, V& x, V& y) {
  const V turned = c * x - s * y;
  y = s * x + c * y;
  x = turned;
}
template <class V>
ARMWRIGHT_INLINE void rotate_back(V c, V s, V& x, V& y) {
  const V turned = c * x + s * y;
  y = c * y - s * x;
  x = turned;
}
// Rotates the symmetric tensor (xx, xy; xy, yy) by the same angle.
template <class V>
ARMWRIGHT_INLINE void rotate_tensor(V c, V s, V& xx, V& xy, V& yy) {
  const V cs = c * s;
  const V ss = s * s;
  const V difference = yy - xx;
  const V cross = cs * xy;
  const V trace = xx + yy;
  xx = xx + ss * difference - (cross + cross);
  xy = xy - (ss + ss) * xy - cs * difference;
  yy = trace - xx;
}

// The posture of one chain in one pack of lanes. Points to the model's numbers; the caller owns
// them.
template <class V, class Chain>
class ChainPosture {
 public:
  // Computes all quantities that depend only on the positions q, one pack per joint. The first
  // joint's sine and cosine are only needed for the tip (`with_first`) and for gravity that is not
  // parallel to its axis.
  ARMWRIGHT_INLINE void set_posture(const V* q, bool with_first) {
    V angle = V(0);
    chain_.for_down(
        chain_.end(), [&](auto i) __attribute__((always_inline)) {
          const V own = chain_.slides(i) ? get(kAngle, i) : q[i] + get(kAngle, i);
          angle = chain_.last_of_group(i) ? own : angle + own;
          if (i > 0 || with_first || chain_.tilted_gravity()) {
            lanes::calc_sine_cosine(angle, s_[i], c_[i]);
          }
          if (chain_.same_axis(i)) {
            arm_x_[i] = c_[i] * get(kOffsetX, i);
            arm_y_[i] = V(0) - s_[i] * get(kOffsetX, i);
          }
        });
  }

  // Returns the tip's position in the base's frame (m). Requires set_posture(q, true).
  ARMWRIGHT_INLINE Vec3<V> calc_tip(const V* q) const {
    return calc_place(q, {single(kTipX), single(kTipY), single(kTipZ)});
  }
  // Returns a tool point's position in the base's frame (m). Requires set_posture(q, true).
  ARMWRIGHT_INLINE Vec3<V> calc_tool_point(const V* q, int point) const {
    const V* const p = model_ + kModelFields * joints() + kToolX + 3 * point;
    return calc_place(q, {p[0], p[1], p[2]});
  }

 protected:
  using List = PackList<V, Chain::kJoints>;

  // Transforms a point p from the last link's frame to the base's frame.
  ARMWRIGHT_INLINE Vec3<V> calc_place(const V* q, Vec3<V> p) const {
    chain_.for_down(
        chain_.end(), [&](auto i) __attribute__((always_inline)) {
          if (chain_.slides(i)) {
            p.z += q[i];
          }
          if (chain_.same_axis(i)) {
            p.x += arm_x_[i];
            p.y += arm_y_[i];
          } else {
            rotate(c_[i], s_[i], p.x, p.y);
            if (i > 0) {
              twist_inwards(i, p.y, p.z);
              p.x += get(kOffsetX, i);
              if (!chain_.along_x(i)) {
                p.y += get(kOffsetY, i);
                p.z += get(kOffsetZ, i);
              }
            }
          }
        });
    return p;
  }

  ARMWRIGHT_INLINE ChainPosture(const Chain& chain, const V* model, V*& scratch)
      : chain_(chain), model_(model) {
    if constexpr (Chain::kJoints == 0) {
      List* const lists[] = {&c_, &s_, &arm_x_, &arm_y_};
      for (List* list : lists) {
        list->place(scratch, joints());
      }
    }
  }

  ARMWRIGHT_INLINE int joints() const { return chain_.joints(); }
  ARMWRIGHT_INLINE V get(ModelField field, int i) const { return model_[field * joints() + i]; }
  ARMWRIGHT_INLINE V single(ModelSingle field) const {
    return model_[kModelFields * joints() + field];
  }

  // Rotate by the twist between a group's frame and the frame before the group. "Inwards" is
  // towards the base, "outwards" towards the tip.
  ARMWRIGHT_INLINE void twist_inwards(int i, V& y, V& z) const {
    if (chain_.right_angle(i)) {
      const V turned = y;
      y = V(0) - z;
      z = turned;
    } else {
      rotate(get(kTwistCos, i), get(kTwistSin, i), y, z);
    }
  }
  ARMWRIGHT_INLINE void twist_outwards(int i, V& y, V& z) const {
    if (chain_.right_angle(i)) {
      const V turned = z;
      z = V(0) - y;
      y = turned;
    } else {
      rotate_back(get(kTwistCos, i), get(kTwistSin, i), y, z);
    }
  }
  ARMWRIGHT_INLINE void turn_inwards(int i, Vec3<V>& v) const {
    rotate(c_[i], s_[i], v.x, v.y);
    twist_inwards(i, v.y, v.z);
  }
  ARMWRIGHT_INLINE void turn_outwards(int i, Vec3<V>& v) const {
    twist_outwards(i, v.y, v.z);
    rotate_back(c_[i], s_[i], v.x, v.y);
  }

  Chain chain_;
  const V* model_;
  List c_, s_;          // cosine and sine of the angle from joint i to its group's end
  List arm_x_, arm_y_;  // offset of joint i from the joint before in its group
};

}  // namespace armwright::articulated
