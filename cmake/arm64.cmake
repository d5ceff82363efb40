# Toolchain file: arm64 from any machine, against unpacked Debian packages; scripts/check_arm64 makes them and uses this.
# SNAPWING_SYSROOT: the folder with the packages.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SNAPWING_SYSROOT)
set(CMAKE_SYSROOT ${SNAPWING_SYSROOT})
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)  # lcm-gen runs here
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-L;${SNAPWING_SYSROOT})
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${SNAPWING_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${SNAPWING_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${SNAPWING_SYSROOT}/usr/share/pkgconfig)
# Libraries that libraries need, as on the target.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--allow-shlib-undefined")
