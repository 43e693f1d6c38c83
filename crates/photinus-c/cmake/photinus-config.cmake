# find_package(photinus) -> photinus::photinus, the shared library, and photinus::static. Found from where this file is installed.

get_filename_component(_photinus_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET photinus::photinus)
    add_library(photinus::photinus SHARED IMPORTED)
    set_target_properties(photinus::photinus PROPERTIES
        IMPORTED_LOCATION "${_photinus_prefix}/lib/libphotinus_c.so.0"
        IMPORTED_SONAME "libphotinus_c.so.0"
        INTERFACE_INCLUDE_DIRECTORIES "${_photinus_prefix}/include")

    add_library(photinus::static STATIC IMPORTED)
    set_target_properties(photinus::static PROPERTIES
        IMPORTED_LOCATION "${_photinus_prefix}/lib/libphotinus_c.a"
        INTERFACE_INCLUDE_DIRECTORIES "${_photinus_prefix}/include"
        INTERFACE_LINK_LIBRARIES "gcc_s;util;rt;pthread;m;dl")
endif()

unset(_photinus_prefix)
