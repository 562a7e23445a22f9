# The standard picture of targets.md, section 7; included by tests/benchmark/CMakeLists.txt.
add_executable(standard_picture "${CMAKE_CURRENT_LIST_DIR}/standard_picture.cpp" "${CMAKE_CURRENT_LIST_DIR}/recorded_rays.cpp")
target_link_libraries(standard_picture PRIVATE softreel_render softreel_warnings fmt::fmt)
add_executable(tree_speed "${CMAKE_CURRENT_LIST_DIR}/tree_speed.cpp")
target_link_libraries(tree_speed PRIVATE softreel_render softreel_warnings fmt::fmt)
target_include_directories(tree_speed PRIVATE "${PROJECT_SOURCE_DIR}")
add_executable(preview_speed "${CMAKE_CURRENT_LIST_DIR}/preview_speed.cpp")
target_link_libraries(preview_speed PRIVATE softreel_render softreel_warnings fmt::fmt)
target_include_directories(preview_speed PRIVATE "${PROJECT_SOURCE_DIR}")
