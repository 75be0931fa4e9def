# whirl_unity(TARGET [FILES]): with WHIRL_UNITY, FILES files of the target (8) are compiled as one, so that their headers
# are read and their templates made once. Files with compile options of their own stay alone.
if(WHIRL_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC warns of unnamed namespaces in every file but the one it was called with, as if that were a header. It collects
  # garbage from a few MB on by default, which costs a fifth of the time; without that a compiler takes up to 1.6 GB.
  add_compile_options(-Wno-subobject-linkage --param=ggc-min-heapsize=1000000)
endif()
function(whirl_unity target)
  set(files ${ARGN} 8)
  list(GET files 0 files)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${WHIRL_UNITY} UNITY_BUILD_BATCH_SIZE ${files})
endfunction()
