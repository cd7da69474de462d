# To be sourced after lib.bash and fleet.bash: a fleet with a short diagnosis, two plants without a missing effect.
# shellcheck disable=SC2154,SC2034 # set by lib.bash; `fleet_file` is for those who source this
fleet_file=$work/fleet.toml
{
  echo '[options]'
  echo 'power_only = true'
  model=whole.toml plant a '"records/e[12].csv"'
  model=whole.toml plant b '"records/e[34].csv"'
} >"$fleet_file"
# whole_fleet COMMAND...: runs it; true if both plants are complete
whole_fleet() { "$@" >"$work/log" 2>&1 && grep -q '^2 plants: .*, 2 adequate[.]$' "$work/log"; }
# same_fleet OUT: true if OUT equals $work/whole and has no leftover files
same_fleet() {
  local file
  for file in fleet.json fleet.csv fleet.html a/plant.json b/plant.json; do
    cmp "$work/whole/$file" "$1/$file" || return 1
  done
  diff <(cd "$work/whole" && find . -not -name .lock | sort) <(cd "$1" && find . -not -name .lock | sort)
}
