// Holds nothing: its target compiles once the headers that numerics begin with, under their
// options.
