// Holds nothing: its target compiles once the headers that most libraries begin with.
