// The equations of motion of a chain (chain_model.hpp) for a pack of lanes:
//   M(q) qdd + b(q, qd) = tau.
// The bias b comes from a recursive Newton-Euler pass at qdd = 0 (Luh, Walker and Paul 1980), the
// mass matrix M from composite rigid bodies (Walker and Orin 1982), and qdd from the factors
// M = L D L^T.
//
// Consecutive joints with parallel axes form a group. All links of a group are treated in one
// frame, that of the group's last link. In it the angular velocities of the group's links differ
// only in the component along the axis. So vectors and composite bodies need no rotation from joint
// to joint; only the links' constant moments are rotated.
//
// All vectors of a link refer to the origin of its group's frame. Let w be the link's angular
// velocity, wd its derivative, and [w]x the matrix of the cross product with w. With
// U = [wd]x + [w]x[w]x and the acceleration a of the origin, a point r of the link has the
// acceleration a + U r. With the link's mass m, first moments s = integral r dm and second moments
// K = integral r r^T dm, the force and the moment about the origin that move the link are
//   force   U s + m a,
//   moment  (A_32 - A_23, A_13 - A_31, A_21 - A_12) + s x a,  A = U K,
// where a includes gravity as an upward acceleration of the base.
//
// V is a lane type (lane_pack.hpp). Chain is a ChainShape, the facts about the chain that are known
// when the code is compiled (chain_shape.hpp).
#pragma once

#include "sim/dynamics/chain_posture.hpp"

namespace armwright::articulated {

// The equations of motion of one chain in one pack of lanes. The caller owns the model's numbers
// and, for a chain of any length, calc_dynamics_packs() packs of scratch memory.
template <class V, class Chain>
class ChainDynamics : public ChainPosture<V, Chain> {
  using Posture = ChainPosture<V, Chain>;
  using Posture::arm_x_, Posture::arm_y_, Posture::c_, Posture::s_;  // set for a posture
  using Posture::chain_;
  using Posture::get, Posture::joints, Posture::single;
  using Posture::turn_inwards, Posture::turn_outwards, Posture::twist_inwards;

 public:
  ARMWRIGHT_INLINE ChainDynamics(const Chain& chain, const V* model, V*& scratch)
      : Posture(chain, model, scratch) {
    if constexpr (Chain::kJoints == 0) {
      List* const lists[] = {&xx_, &xy_, &xz_, &yy_, &yz_,  &sx_,  &sy_,  &bias_, &fx_,  &fy_,
                             &fz_, &nx_, &ny_, &nz_, &cfx_, &cfy_, &cfz_, &cnx_,  &cny_, &cnz_};
      for (List* list : lists) {
        list->place(scratch, joints());
      }
      mass_.place(scratch, joints() * joints());
    }
  }

  // Computes M and b for the posture that set_posture() has set; q and rate have one pack per
  // joint.
  ARMWRIGHT_INLINE void calc_equations(const V* q, const V* rate) {
    go_outwards(q, rate);
    come_back(q);
  }
  ARMWRIGHT_INLINE V mass(int row, int column) const {  // row >= column
    return mass_[row * joints() + column];
  }
  ARMWRIGHT_INLINE V bias(int row) const { return bias_[row]; }

  // Adds inertia that turns with a joint, such as its motor's, to M.
  ARMWRIGHT_INLINE void add_inertia(int joint, V inertia) { entry(joint, joint) += inertia; }

  // Computes qdd = M^-1 (tau - b). Overwrites M.
  ARMWRIGHT_INLINE void solve(const V* effort, V* acceleration) {
    // Factors M = L D L' in place: L below the diagonal, 1 / D on it, D L' above it.
    chain_.for_up([&](auto j) __attribute__((always_inline)) {
      V diagonal = entry(j, j);
      V sum = effort[j] - bias_[j];
      chain_.for_below(
          j, [&](auto k) __attribute__((always_inline)) {
            diagonal -= entry(j, k) * entry(k, j);
            sum -= entry(j, k) * acceleration[k];
          });
      acceleration[j] = sum;  // of L y = tau - b
      const V inverse = V(1) / diagonal;
      entry(j, j) = inverse;
      chain_.for_from(
          chain_.next(j), [&](auto i) __attribute__((always_inline)) {
            V below = entry(i, j);
            chain_.for_below(
                j, [&](auto k)
                       __attribute__((always_inline)) { below -= entry(i, k) * entry(k, j); });
            entry(j, i) = below;
            entry(i, j) = below * inverse;
          });
    });
    chain_.for_down(
        chain_.end(), [&](auto j) __attribute__((always_inline)) {
          V sum = acceleration[j] * entry(j, j);
          chain_.for_from(
              chain_.next(j), [&](auto i) __attribute__((always_inline)) {
                sum -= entry(i, j) * acceleration[i];
              });
          acceleration[j] = sum;
        });
  }

 private:
  using typename Posture::List;

  ARMWRIGHT_INLINE V& entry(int row, int column) { return mass_[row * joints() + column]; }

  // Rotate the link's constant moments into its group's frame.
  ARMWRIGHT_INLINE void turn_first_moments(int i) {
    sx_[i] = get(kMomentX, i);
    sy_[i] = get(kMomentY, i);
    if (!chain_.last_of_group(i)) {
      rotate_back(c_[i + 1], s_[i + 1], sx_[i], sy_[i]);
    }
  }
  ARMWRIGHT_INLINE void turn_second_moments(int i) {
    xx_[i] = get(kSecondXX, i);
    xy_[i] = get(kSecondXY, i);
    xz_[i] = get(kSecondXZ, i);
    yy_[i] = get(kSecondYY, i);
    yz_[i] = get(kSecondYZ, i);
    if (!chain_.last_of_group(i)) {
      rotate_back(c_[i + 1], s_[i + 1], xz_[i], yz_[i]);
      rotate_tensor(c_[i + 1], V(0) - s_[i + 1], xx_[i], xy_[i], yy_[i]);
    }
  }

  // The motion of a link, in its group's frame.
  struct Motion {
    Vec3<V> a;      // acceleration of its origin minus gravity
    Vec3<V> w, wd;  // angular velocity of the link before the group, and its derivative
    V u11, u12, u13, u21, u22, u23, u31, u32, u33;
    V turned;  // angular velocity of the link about the group's axis relative to w
    // Terms that are the same for all links of the group.
    V w11, w22, b31, b32, wx_twice, wy_twice;
  };

  ARMWRIGHT_INLINE void go_outwards(const V* q, const V* rate) {
    const V zero = V(0);
    Motion m{{single(kGravityX), zero, single(kGravityZ)},
             {zero, zero, zero},
             {zero, zero, zero},
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero,
             zero};
    if (chain_.tilted_gravity()) {
      rotate_back(c_[0], s_[0], m.a.x, m.a.y);
    }
    chain_.for_up([&](auto i) __attribute__((always_inline)) {
      if (chain_.in_base_group(i)) {
        pass_base_link(i, m, rate);
      } else {
        if (!chain_.same_axis(i)) {
          enter_group(i, m);
        }
        pass_link(i, m, q, rate);
      }
    });
  }

  // Handles a link of the group on the fixed base. All points of these links move in planes
  // perpendicular to the axis. Only forces in these planes and moments about the axis do work.
  ARMWRIGHT_INLINE void pass_base_link(int i, Motion& m, const V* rate) {
    turn_first_moments(i);
    if (i > 0) {
      m.a.x += m.u11 * arm_x_[i];
      m.a.y += m.u11 * arm_y_[i];
      m.turned += rate[i];
    } else {
      m.turned = rate[0];
    }
    m.u11 = V(0) - m.turned * m.turned;
    fx_[i] = m.u11 * sx_[i];
    fy_[i] = m.u11 * sy_[i];
    nz_[i] = sx_[i] * m.a.y - sy_[i] * m.a.x;
  }

  ARMWRIGHT_INLINE void enter_group(int i, Motion& m) {
    const bool from_base = i > 0 && chain_.in_base_group(i - 1);
    const bool steady = i == 0 || from_base || chain_.in_first_group(i - 1);  // wd is 0
    if (from_base) {  // U = diag(u11, u11, 0), w = (0, 0, turned)
      m.a.x += m.u11 * get(kOffsetX, i);
      if (!chain_.along_x(i)) {
        m.a.y += m.u11 * get(kOffsetY, i);
      }
      m.w.z = m.turned;
    } else if (i > 0) {
      const V x = get(kOffsetX, i);
      m.a.x += m.u11 * x;
      m.a.y += m.u21 * x;
      m.a.z += m.u31 * x;
      if (!chain_.along_x(i)) {
        const V y = get(kOffsetY, i);
        const V z = get(kOffsetZ, i);
        m.a.x += m.u12 * y + m.u13 * z;
        m.a.y += m.u22 * y + m.u23 * z;
        m.a.z += m.u32 * y + m.u33 * z;
      }
      m.wd.x += m.w.y * m.turned;
      m.wd.y -= m.w.x * m.turned;
      m.w.z += m.turned;
    }
    if (i > 0) {
      turn_outwards(i, m.a);
      if (from_base) {  // only its z component is not zero
        if (chain_.right_angle(i)) {
          m.w.y = m.w.z;
          m.w.z = V(0);
        } else {
          m.w.y = get(kTwistSin, i) * m.w.z;
          m.w.z = get(kTwistCos, i) * m.w.z;
        }
        m.w.x = s_[i] * m.w.y;
        m.w.y = c_[i] * m.w.y;
      } else {
        turn_outwards(i, m.w);
      }
      if (!steady) {
        turn_outwards(i, m.wd);
      }
    }
    m.w11 = m.w.x * m.w.x;
    m.w22 = m.w.y * m.w.y;
    m.b31 = m.w.x * m.w.z;
    m.b32 = m.w.y * m.w.z;
    m.u12 = m.w.x * m.w.y;
    m.u21 = m.u12;
    m.u13 = m.b31;
    m.u23 = m.b32;
    if (!steady) {
      m.b31 -= m.wd.y;
      m.b32 += m.wd.x;
      m.u12 -= m.wd.z;
      m.u21 += m.wd.z;
      m.u13 += m.wd.y;
      m.u23 -= m.wd.x;
    }
    m.u33 = V(0) - (m.w11 + m.w22);
    m.wx_twice = m.w.x + m.w.x;
    m.wy_twice = m.w.y + m.w.y;
    m.turned = V(0);
  }

  ARMWRIGHT_INLINE void pass_link(int i, Motion& m, const V* q, const V* rate) {
    turn_first_moments(i);
    turn_second_moments(i);
    if (chain_.same_axis(i)) {
      m.a.x += m.u11 * arm_x_[i] + m.u12 * arm_y_[i];
      m.a.y += m.u21 * arm_x_[i] + m.u22 * arm_y_[i];
      m.a.z += m.u31 * arm_x_[i] + m.u32 * arm_y_[i];
    }
    if (chain_.slides(i)) {
      m.a.x += m.u13 * q[i] + m.wy_twice * rate[i];
      m.a.y += m.u23 * q[i] - m.wx_twice * rate[i];
      m.a.z += m.u33 * q[i];
    } else {
      m.turned = chain_.same_axis(i) ? m.turned + rate[i] : rate[i];
    }
    const V spin = m.w.z + m.turned;
    const V square = spin * spin;
    m.u11 = V(0) - (m.w22 + square);
    m.u22 = V(0) - (m.w11 + square);
    m.u31 = m.b31 + m.wx_twice * m.turned;
    m.u32 = m.b32 + m.wy_twice * m.turned;
    load_link(i, m);
  }

  // Computes the force that moves link i and the moment about its frame's origin.
  ARMWRIGHT_INLINE void load_link(int i, const Motion& m) {
    const V sx = sx_[i], sy = sy_[i];
    const V xx = xx_[i], xy = xy_[i], xz = xz_[i], yy = yy_[i], yz = yz_[i];
    fx_[i] = m.u11 * sx + m.u12 * sy;
    fy_[i] = m.u21 * sx + m.u22 * sy;
    fz_[i] = m.u31 * sx + m.u32 * sy;
    nx_[i] = xy * m.u31 + yy * m.u32 + yz * (m.u33 - m.u22) - xz * m.u21 + sy * m.a.z;
    ny_[i] = xz * (m.u11 - m.u33) + yz * m.u12 - xx * m.u31 - xy * m.u32 - sx * m.a.z;
    nz_[i] = xx * m.u21 + xy * (m.u22 - m.u11) + xz * m.u23 - yy * m.u12 - yz * m.u13 +
             (sx * m.a.y - sy * m.a.x);
    if constexpr (Chain::kSliding) {
      const V sz = get(kMomentZ, i);
      const V mass = get(kMass, i);
      fx_[i] += m.u13 * sz + mass * m.a.x;
      fy_[i] += m.u23 * sz + mass * m.a.y;
      fz_[i] += m.u33 * sz + mass * m.a.z;
      nx_[i] -= sz * m.a.y;
      ny_[i] += sz * m.a.x;
    }
  }

  // The composite body of a link and all links after it: their forces and moments at qdd = 0, and
  // their moments of mass, about the link's origin. `mass` is only used if joints may be prismatic
  // (chain_model.hpp).
  struct Outer {
    Vec3<V> f, n;
    V xx, xy, xz, yy, yz, zz;
    Vec3<V> h;
    V mass;
  };

  ARMWRIGHT_INLINE void come_back(const V* q) {
    const V zero = V(0);
    Outer o{{zero, zero, zero},
            {zero, zero, zero},
            zero,
            zero,
            zero,
            zero,
            zero,
            zero,
            {zero, zero, zero},
            zero};
    chain_.for_down(
        chain_.end(), [&](auto i) __attribute__((always_inline)) {
          if (chain_.in_base_group(i)) {
            come_back_to_base_link(i, o);
          } else {
            come_back_to_link(i, o, q);
          }
        });
  }

  template <class Index>
  ARMWRIGHT_INLINE void come_back_to_link(Index i, Outer& o, const V* q) {
    const V zero = V(0);
    add_link(i, o);
    if (chain_.slides(i)) {
      bias_[i] = o.f.z;
      set_column(i, {zero, zero, o.mass}, {o.h.y, zero - o.h.x, zero});
      chain_.for_from(
          i, [&](auto j) __attribute__((always_inline)) { entry(j, i) = cfz_[j]; });
      shift_along_axis(q[i], i, o);
    } else {
      bias_[i] = o.n.z;
      set_column(i, {zero - o.h.y, o.h.x, zero}, {zero - o.xz, zero - o.yz, o.xx + o.yy});
      chain_.for_from(
          i, [&](auto j) __attribute__((always_inline)) { entry(j, i) = cnz_[j]; });
    }
    if (chain_.same_axis(i)) {
      shift_in_group(i, o);
    } else if (i > 0) {
      leave_group(i, o);
      if (chain_.in_base_group(i - 1)) {
        o.xx += o.yy;  // xx is the moment of inertia about the axis from here on
      }
    }
  }

  ARMWRIGHT_INLINE void set_column(int i, const Vec3<V>& f, const Vec3<V>& n) {
    cfx_[i] = f.x;
    cfy_[i] = f.y;
    cfz_[i] = f.z;
    cnx_[i] = n.x;
    cny_[i] = n.y;
    cnz_[i] = n.z;
  }

  ARMWRIGHT_INLINE void add_link(int i, Outer& o) {
    o.f.x += fx_[i];
    o.f.y += fy_[i];
    o.f.z += fz_[i];
    o.n.x += nx_[i];
    o.n.y += ny_[i];
    o.n.z += nz_[i];
    o.xx += xx_[i];
    o.xy += xy_[i];
    o.xz += xz_[i];
    o.yy += yy_[i];
    o.yz += yz_[i];
    o.h.x += sx_[i];
    o.h.y += sy_[i];
    if constexpr (Chain::kSliding) {
      o.h.z += get(kMomentZ, i);
      o.mass += get(kMass, i);
    }
  }

  template <class Index>
  ARMWRIGHT_INLINE void shift_along_axis(V way, Index i, Outer& o) {
    o.n.x -= way * o.f.y;
    o.n.y += way * o.f.x;
    chain_.for_from(
        i, [&](auto j) __attribute__((always_inline)) {
          cnx_[j] -= way * cfy_[j];
          cny_[j] += way * cfx_[j];
        });
    o.xz += way * o.h.x;
    o.yz += way * o.h.y;
    o.zz += way * (o.h.z + o.h.z + way * o.mass);
    o.h.z += way * o.mass;
  }

  // Moves the reference point to the origin of the joint before in the same group.
  template <class Index>
  ARMWRIGHT_INLINE void shift_in_group(Index i, Outer& o) {
    const V x = arm_x_[i];
    const V y = arm_y_[i];
    o.n.x += y * o.f.z;
    o.n.y -= x * o.f.z;
    o.n.z += x * o.f.y - y * o.f.x;
    chain_.for_from(
        i, [&](auto j) __attribute__((always_inline)) {
          cnz_[j] += x * cfy_[j] - y * cfx_[j];
          // Forces of the group's own revolute joints have no component along the axis.
          if (Chain::kSliding || !chain_.in_same_group(i, j)) {
            cnx_[j] += y * cfz_[j];
            cny_[j] -= x * cfz_[j];
          }
        });
    const V xhx = x * o.h.x;
    const V yhy = y * o.h.y;
    o.xx += xhx + xhx;
    o.yy += yhy + yhy;
    o.xy += x * o.h.y + y * o.h.x;
    if (Chain::kSliding || !chain_.in_last_group(i)) {
      o.xz += x * o.h.z;
      o.yz += y * o.h.z;
    }
    if constexpr (Chain::kSliding) {
      const V mx = o.mass * x;
      const V my = o.mass * y;
      o.xx += mx * x;
      o.xy += mx * y;
      o.yy += my * y;
      o.h.x += mx;
      o.h.y += my;
    }
  }

  // Transforms to the frame of the link before the group, which belongs to another group.
  template <class Index>
  ARMWRIGHT_INLINE void leave_group(Index i, Outer& o) {
    const V x = get(kOffsetX, i);
    const V y = get(kOffsetY, i);
    const V z = get(kOffsetZ, i);
    const bool straight = chain_.along_x(i);
    const auto turn = [&](Vec3<V> & force, Vec3<V> & moment) __attribute__((always_inline)) {
      turn_inwards(i, force);
      turn_inwards(i, moment);
      moment.y -= x * force.z;
      moment.z += x * force.y;
      if (!straight) {
        moment.x += y * force.z - z * force.y;
        moment.y += z * force.x;
        moment.z -= y * force.x;
      }
    };
    turn(o.f, o.n);
    chain_.for_from(
        i, [&](auto j) __attribute__((always_inline)) {
          Vec3<V> force{cfx_[j], cfy_[j], cfz_[j]};
          Vec3<V> moment{cnx_[j], cny_[j], cnz_[j]};
          turn(force, moment);
          set_column(j, force, moment);
        });

    rotate_tensor(c_[i], s_[i], o.xx, o.xy, o.yy);
    rotate(c_[i], s_[i], o.xz, o.yz);
    twist_inwards(i, o.xy, o.xz);
    if (chain_.right_angle(i)) {
      const V yy = o.yy;
      o.yy = o.zz;
      o.zz = yy;
      o.yz = V(0) - o.yz;
    } else {
      rotate_tensor(get(kTwistCos, i), get(kTwistSin, i), o.yy, o.yz, o.zz);
    }
    turn_inwards(i, o.h);
    const V xhx = x * o.h.x;
    o.xx += xhx + xhx;
    o.xy += x * o.h.y;
    o.xz += x * o.h.z;
    if (!straight) {
      const V yhy = y * o.h.y;
      const V zhz = z * o.h.z;
      o.xy += y * o.h.x;
      o.xz += z * o.h.x;
      o.yy += yhy + yhy;
      o.yz += y * o.h.z + z * o.h.y;
      o.zz += zhz + zhz;
    }
    if constexpr (Chain::kSliding) {
      const V mx = o.mass * x;
      const V my = o.mass * y;
      const V mz = o.mass * z;
      o.xx += mx * x;
      o.xy += mx * y;
      o.xz += mx * z;
      o.yy += my * y;
      o.yz += my * z;
      o.zz += mz * z;
      o.h.x += mx;
      o.h.y += my;
      o.h.z += mz;
    }
  }

  template <class Index>
  ARMWRIGHT_INLINE void come_back_to_base_link(Index i, Outer& o) {
    o.f.x += fx_[i];
    o.f.y += fy_[i];
    o.n.z += nz_[i];
    bias_[i] = o.n.z;
    o.xx += get(kSecondXX, i) + get(kSecondYY, i);
    o.h.x += sx_[i];
    o.h.y += sy_[i];
    cfx_[i] = V(0) - o.h.y;
    cfy_[i] = o.h.x;
    cnz_[i] = o.xx;
    chain_.for_from(
        i, [&](auto j) __attribute__((always_inline)) { entry(j, i) = cnz_[j]; });
    if (i > 0) {
      const V x = arm_x_[i];
      const V y = arm_y_[i];
      o.n.z += x * o.f.y - y * o.f.x;
      chain_.for_from(
          i, [&](auto j) __attribute__((always_inline)) { cnz_[j] += x * cfy_[j] - y * cfx_[j]; });
      const V once = x * o.h.x + y * o.h.y;
      o.xx += once + once;
    }
  }

  List xx_, xy_, xz_, yy_, yz_, sx_, sy_;  // moments in the group's frame
  List bias_;
  List fx_, fy_, fz_, nx_, ny_, nz_;                   // forces and moments of links at qdd = 0
  List cfx_, cfy_, cfz_, cnx_, cny_, cnz_;             // per joint i, for qdd_i = 1 alone
  PackList<V, Chain::kJoints * Chain::kJoints> mass_;  // row-major
};

}  // namespace armwright::articulated
