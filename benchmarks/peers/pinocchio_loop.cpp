// Pinocchio without Python: computeFrameJacobian in a loop, with LAPACK or with Eigen for what follows.
//
//   pinocchio_loop CHAIN CONFIGURATIONS LAPACK
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "loop.hpp"

namespace pin = pinocchio;

pin::SE3 placement(const Chain::Step& step) {
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return pin::SE3(Eigen::Map<const Rows>(step.rotation), Eigen::Map<const Eigen::Vector3d>(step.translation));
}

pin::JointModel joint(const Chain::Step& step) {
  const Eigen::Vector3d axis = Eigen::Map<const Eigen::Vector3d>(step.axis);
  const bool turns = step.type == "revolute";
  for (int i = 0; i < 3; ++i)
    if (axis == Eigen::Vector3d::Unit(i)) switch (i) {
        case 0: return turns ? pin::JointModel(pin::JointModelRX()) : pin::JointModel(pin::JointModelPX());
        case 1: return turns ? pin::JointModel(pin::JointModelRY()) : pin::JointModel(pin::JointModelPY());
        default: return turns ? pin::JointModel(pin::JointModelRZ()) : pin::JointModel(pin::JointModelPZ());
      }
  if (turns) return pin::JointModelRevoluteUnaligned(axis);
  return pin::JointModelPrismaticUnaligned(axis);
}

int main(int, char** argv) {
  const Chain chain = read_chain(argv[1]);
  const auto q = read_configurations(argv[2]);
  const Lapack lapack(argv[3]);
  pin::Model model;
  pin::JointIndex last = 0;
  for (const auto& step : chain.joints)
    last = model.addJoint(last, joint(step), placement(step), "j" + std::to_string(last));
  const auto tool = model.addFrame(pin::Frame("tool", last, 0, placement(chain.tool), pin::OP_FRAME));
  pin::Data data(model);
  const int n = model.nv, k = least(n);
  pin::Data::Matrix6x matrix(6, n);
  matrix.setZero();
  auto jacobian = [&](const double* at) {
    pin::computeFrameJacobian(model, data, Eigen::Map<const Eigen::VectorXd>(at, n), tool, pin::LOCAL_WORLD_ALIGNED,
                              matrix);
  };
  auto two_calls = [&](const double* at) {
    pin::computeJointJacobians(model, data, Eigen::Map<const Eigen::VectorXd>(at, n));
    pin::getFrameJacobian(model, data, tool, pin::LOCAL_WORLD_ALIGNED, matrix);
  };
  Eigen::JacobiSVD<Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 16>> svd;

  Questions all{q, n, {}};
  all.add("jacobian/computeFrameJacobian", [&](const double* at, double* out) {
    jacobian(at);
    out[0] = matrix(0, 0);
    return 0;
  });
  all.add("jacobian/computeJointJacobians", [&](const double* at, double* out) {
    two_calls(at);
    out[0] = matrix(0, 0);
    return 0;
  });
  all.add("yoshikawa/LAPACK singular values", [&](const double* at, double* out) {
    double values[ROWS];
    jacobian(at);
    lapack.singular_values(matrix.data(), n, values);
    out[0] = product(values, k);
    return 1;
  });
  if (n >= ROWS) {
    all.add("yoshikawa/LAPACK det", [&](const double* at, double* out) {
      jacobian(at);
      out[0] = lapack.yoshikawa(matrix.data(), n);
      return 1;
    });
    all.add("yoshikawa/Eigen det", [&](const double* at, double* out) {
      jacobian(at);
      if (n == ROWS) {
        out[0] = std::abs(Eigen::Matrix<double, 6, 6>(matrix).determinant());
      } else {
        const Eigen::Matrix<double, 6, 6> square = matrix.lazyProduct(matrix.transpose());
        out[0] = std::sqrt(square.determinant());
      }
      return 1;
    });
  }
  all.add("singular_values/LAPACK", [&](const double* at, double* out) {
    jacobian(at);
    lapack.singular_values(matrix.data(), n, out);
    return k;
  });
  all.add("singular_values/Eigen JacobiSVD", [&](const double* at, double* out) {
    jacobian(at);
    svd.compute(matrix);
    std::copy(svd.singularValues().data(), svd.singularValues().data() + k, out);
    return k;
  });
  all.serve("Pinocchio " PINOCCHIO_VERSION " (C++)");
}
