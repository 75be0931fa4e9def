// For programs with sanitizers. Open MPI unloads its plugins at the end; the leak report then cannot name them, and no
// suppression fits.

extern "C" int dlclose(void*) {
  return 0;
}
