// Holds nothing: its target compiles once the headers that tests begin with.
int main() {
  return 0;
}
