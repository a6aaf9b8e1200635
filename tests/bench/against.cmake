# frame_times of this tree in the project of another commit: scripts/bench against hands this file to that commit's
# cmake, which includes it right after project(). The libraries are that commit's.
add_executable(frame_times_against
	${CMAKE_CURRENT_LIST_DIR}/frame_times.c ${CMAKE_CURRENT_LIST_DIR}/bench_options.c
	${CMAKE_CURRENT_LIST_DIR}/bench_scene.c ${CMAKE_CURRENT_LIST_DIR}/samples.c)
set_target_properties(frame_times_against PROPERTIES
	C_STANDARD 17 C_STANDARD_REQUIRED ON RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
target_link_libraries(frame_times_against PRIVATE scenes engine gi m)
