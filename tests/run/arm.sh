#!/usr/bin/env bash
# The same bits on Arm: builds the program for 64-bit Arm, with the libraries of Debian's packages, and runs the scenes
# of processors.sh under QEMU. Takes a quarter of an hour and 1 GB in a folder of its own, which APOTHEM_ARM names; what
# the folder has from an earlier time is not made again. Needs the packages g++-aarch64-linux-gnu and qemu-user.
# Usage: APOTHEM_ARM=FOLDER arm.sh PROGRAM. PROGRAM is that of this machine. Exit code 77: no folder is named.
set -euo pipefail
[ -n "${APOTHEM_ARM:-}" ] || exit 77
for tool in aarch64-linux-gnu-g++ qemu-aarch64; do
  command -v $tool >/dev/null || { echo "arm.sh: there is no $tool; apt-get install g++-aarch64-linux-gnu qemu-user" >&2; exit 2; }
done
tests=$(cd "$(dirname "$0")" && pwd)
program=$(realpath "$1")
mkdir -p "$APOTHEM_ARM" && cd "$APOTHEM_ARM" && folder=$PWD

# Folders of its own for apt, in which nothing is installed: all libraries come, and this system stays as it is.
if [ ! -d sysroot ]; then
  mkdir -p apt/lists apt/cache/archives/partial sysroot.part
  : >apt/status
  apt=(apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State::lists="$folder/apt/lists"
       -o Dir::State::status="$folder/apt/status" -o Dir::Cache="$folder/apt/cache" -o APT::Sandbox::User=root)
  "${apt[@]}" update
  "${apt[@]}" install -y --download-only --no-install-recommends libvtk9.1 libgmp-dev libmpfr-dev libcairo2-dev libfmt-dev \
    libsleef-dev zlib1g-dev
  for package in apt/cache/archives/*.deb; do dpkg-deb -x "$package" sysroot.part; done
  mv sysroot.part sysroot
  rm -r apt
fi

# Libraries of Arm; headers without a library of their own are those of this system.
cat >toolchain.cmake <<END
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH $folder/sysroot)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L $folder/sysroot)
set(CMAKE_EXE_LINKER_FLAGS_INIT "-L$folder/sysroot/usr/lib/aarch64-linux-gnu -Wl,--allow-shlib-undefined")
foreach(lib usr/lib lib)
  string(APPEND CMAKE_EXE_LINKER_FLAGS_INIT " -Wl,-rpath-link,$folder/sysroot/\${lib}/aarch64-linux-gnu")
endforeach()
END
here=$(dpkg-architecture -qDEB_HOST_MULTIARCH 2>/dev/null || gcc -print-multiarch)
cmake -S "$tests/../.." -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON \
  -DCMAKE_TOOLCHAIN_FILE="$folder/toolchain.cmake" -DCGAL_DIR="/usr/lib/$here/cmake/CGAL" \
  -DBoost_DIR="$(echo /usr/lib/"$here"/cmake/Boost-*)" >/dev/null
cmake --build build
# The program starts a helper, which is no program to this kernel.
if [ ! -e build/apothem-skeleton.arm ] || [ build/apothem-skeleton -nt build/apothem-skeleton.arm ]; then
  mv build/apothem-skeleton build/apothem-skeleton.arm
  printf '#!/bin/sh\nexec qemu-aarch64 -L "%s/sysroot" "%s/build/apothem-skeleton.arm" "$@"\n' "$folder" "$folder" \
    >build/apothem-skeleton
  chmod +x build/apothem-skeleton
  touch build/apothem-skeleton.arm
fi
exec "$tests/processors.sh" "$program" "qemu-aarch64 -L $folder/sysroot $folder/build/apothem"
