# softreel_bench, started by `softreel bench`; included by tests/benchmark/CMakeLists.txt. Each sub-benchmark adds its
# sources to bench_parts, which bench_tests link too.
add_library(bench_parts STATIC
  bench.cpp
  dial/dial.cpp dial/dial_study.cpp dial/plane_bar.cpp
  limits/bending_bar.cpp limits/cost_curve.cpp limits/limits.cpp limits/strain_cells.cpp limits/tet_remedies.cpp
  report/machine.cpp report/plot.cpp report/report.cpp report/table.cpp
  precision/bar_models.cpp precision/bar_motions.cpp precision/bar_statics.cpp precision/beam_theory.cpp
  precision/calculix.cpp precision/creature.cpp precision/methods.cpp precision/motion.cpp precision/moving_bars.cpp
  precision/precision.cpp precision/static_answer.cpp precision/work_precision.cpp
  scale/scale.cpp
  stability/abuse_study.cpp stability/abuses.cpp stability/bar_body.cpp stability/body_picture.cpp
  stability/held_pose.cpp stability/pose_study.cpp stability/scramble_study.cpp stability/stability.cpp
  stability/watch.cpp
  steppers/descent_memory.cpp steppers/direct_stepper.cpp steppers/projective_stepper.cpp steppers/rival_body.cpp
  steppers/softreel_stepper.cpp steppers/xpbd_stepper.cpp)
target_link_libraries(bench_parts PUBLIC bar_problem rivals softreel_core fmt::fmt
                      PRIVATE softreel_tool softreel_warnings)
target_include_directories(bench_parts PUBLIC "${PROJECT_SOURCE_DIR}")
target_compile_definitions(bench_parts PRIVATE SOFTREEL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
softreel_compile_in_groups(bench_parts 5)

add_executable(softreel_bench bench_main.cpp)
target_link_libraries(softreel_bench PRIVATE bench_parts softreel_warnings)

# Its points of scale are processes of their own, whose memory is the program's: large meshes need huge pages most.
add_executable(scale_point scale_point.cpp)
target_link_libraries(scale_point PRIVATE bar_problem softreel_core softreel_huge_pages softreel_warnings fmt::fmt)
if(NOT SOFTREEL_SANITIZE)
  target_link_libraries(scale_point PRIVATE TBB::tbbmalloc_proxy)
endif()
target_compile_definitions(scale_point PRIVATE SOFTREEL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
add_dependencies(softreel_bench scale_point)
