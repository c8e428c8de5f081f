// MuJoCo without Python: mj_kinematics, mj_comPos, mj_jac in a loop, with LAPACK for what follows.
//
//   mujoco_loop URDF CONFIGURATIONS LAPACK x y z     (the tool in the last body's axes)
#include <mujoco/mujoco.h>

#include "loop.hpp"

int main(int, char** argv) {
  const auto q = read_configurations(argv[2]);
  const Lapack lapack(argv[3]);
  const double offset[3] = {std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6])};
  char error[1000] = "";
  mjModel* model = mj_loadXML(argv[1], nullptr, error, sizeof error);
  if (model == nullptr) {
    std::cerr << error << std::endl;
    return 1;
  }
  mjData* data = mj_makeData(model);
  const int n = static_cast<int>(model->nv), k = least(n), last = static_cast<int>(model->nbody) - 1;
  std::vector<double> rows(6 * n), matrix(6 * n);
  auto jacobian = [&](const double* at) {
    std::copy(at, at + n, data->qpos);
    mj_kinematics(model, data);
    mj_comPos(model, data);
    double point[3];
    mju_mulMatVec3(point, data->xmat + 9 * last, offset);
    mju_addTo3(point, data->xpos + 3 * last);
    mj_jac(model, data, rows.data(), rows.data() + 3 * n, point, last);
  };
  auto columns = [&] {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < 6; ++i) matrix[6 * j + i] = rows[n * i + j];
  };

  Questions all{q, n, {}};
  all.add("jacobian/mj_jac", [&](const double* at, double* out) {
    jacobian(at);
    out[0] = rows[0];
    return 0;
  });
  all.add("yoshikawa/LAPACK singular values", [&](const double* at, double* out) {
    double values[ROWS];
    jacobian(at);
    columns();
    lapack.singular_values(matrix.data(), n, values);
    out[0] = product(values, k);
    return 1;
  });
  if (n >= ROWS) {
    all.add("yoshikawa/LAPACK det", [&](const double* at, double* out) {
      jacobian(at);
      columns();
      out[0] = lapack.yoshikawa(matrix.data(), n);
      return 1;
    });
  }
  all.add("singular_values/LAPACK", [&](const double* at, double* out) {
    jacobian(at);
    columns();
    lapack.singular_values(matrix.data(), n, out);
    return k;
  });
  all.serve(std::string("MuJoCo ") + mj_versionString() + " (C)");
}
