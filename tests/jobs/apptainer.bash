# Sourced by the tests of packaging/swingbank.def, after lib.bash.

# section_of NAME: the lines of a section of the definition
section_of() {
  awk -v wanted="%$1" '/^%/ {on = ($1 == wanted); next} on && NF' "$SWINGBANK_SOURCE/packaging/swingbank.def"
}
