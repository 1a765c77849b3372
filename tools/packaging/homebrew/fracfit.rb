# SPDX-License-Identifier: BSD-3-Clause
# The C++ libraries for Homebrew on Linux, from this clone: `brew install --HEAD tools/packaging/homebrew/fracfit.rb`.
class Fracfit < Formula
  desc "Fractional-order models, their fits to data, and describing functions of two masses with backlash"
  license "BSD-3-Clause"
  head "file://#{File.expand_path("../../..", __dir__)}", using: :git

  depends_on "cmake" => [:build, :test]
  depends_on "ninja" => :build
  depends_on "boost"
  depends_on "ceres-solver"
  depends_on "eigen"
  depends_on :linux
  depends_on "nlopt"

  def install
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DFRAC_BUILD_TOOLS=OFF", "-DFRAC_BUILD_TESTS=OFF",
           "-DFRAC_BUILD_BENCHMARKS=OFF", "-DFRACFIT_MAT_FILES=OFF", "-DFRACFIT_EXPORTS=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    (testpath/"CMakeLists.txt").write <<~CMAKE
      cmake_minimum_required(VERSION 3.22)
      project(consumer CXX)
      find_package(fracfit REQUIRED)
    CMAKE
    system "cmake", "."
  end
end
