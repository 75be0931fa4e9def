# whirl_room(NAME USES target...): a static library whirl_NAME of all .cpp files below src/NAME with headers in include/whirl/NAME.
function(whirl_room name)
  cmake_parse_arguments(ROOM "" "" "USES;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${name}/*.cpp)
  add_library(whirl_${name} STATIC ${sources})
  add_library(whirl::${name} ALIAS whirl_${name})
  target_include_directories(whirl_${name} PUBLIC ${PROJECT_SOURCE_DIR}/include PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(whirl_${name} PUBLIC ${ROOM_USES} PRIVATE ${ROOM_PRIVATE} whirl_flags)
endfunction()
