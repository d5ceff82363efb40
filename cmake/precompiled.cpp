// Gives a precompiled header the target that CMake asks for; it is compiled and never run.
int main() { return 0; }
