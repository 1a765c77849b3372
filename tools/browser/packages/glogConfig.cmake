add_library(glog::glog INTERFACE IMPORTED)
target_include_directories(glog::glog INTERFACE ${CMAKE_CURRENT_LIST_DIR})
