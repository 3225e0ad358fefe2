# opencascade-sys 0.3.0 looks for OCCT by CMake, wants 7.8 or later and links the toolkits under the names they have
# since 7.8. Debian 12 has 7.6.3. This package file answers for it: it makes links from the new names to the old
# libraries in the build directory and reports 7.8. CMake finds it through DEP_OCCT_ROOT (.cargo/config.toml).
# What the crate includes and 7.6 lacks lies in cpp/occt76-shim/include.
set(occt_libraries /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
if(NOT EXISTS ${occt_libraries}/libTKernel.so)
  message(FATAL_ERROR
    "OCCT 7.6 not found (${occt_libraries}/libTKernel.so). On Debian 12: apt-get install libocct-foundation-dev "
    "libocct-modeling-data-dev libocct-modeling-algorithms-dev libocct-data-exchange-dev libocct-ocaf-dev")
endif()

set(same_name TKernel TKMath TKG2d TKG3d TKGeomBase TKBRep TKGeomAlgo TKTopAlgo TKPrim TKBO TKBool TKFillet TKFeat
    TKOffset TKShHealing TKMesh TKXSBase TKCAF TKLCAF TKXCAF)
set(occt_links ${CMAKE_BINARY_DIR}/occt-links)
file(MAKE_DIRECTORY ${occt_links})
function(link_toolkit wanted debian)
  file(CREATE_LINK ${occt_libraries}/lib${debian}.so ${occt_links}/lib${wanted}.so SYMBOLIC)
endfunction()
foreach(toolkit ${same_name})
  link_toolkit(${toolkit} ${toolkit})
endforeach()
link_toolkit(TKDE TKXSBase)
link_toolkit(TKDESTEP TKSTEP)
link_toolkit(TKDEIGES TKIGES)
link_toolkit(TKDESTL TKSTL)

set(OpenCASCADE_MAJOR_VERSION 7)
set(OpenCASCADE_MINOR_VERSION 8)
set(OpenCASCADE_INCLUDE_DIR /usr/include/opencascade)
set(OpenCASCADE_LIBRARY_DIR ${occt_links})
set(OpenCASCADE_BUILD_SHARED_LIBS ON)
