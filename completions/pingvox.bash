# bash completion for pingvox. Needs nothing of the bash-completion package, and uses nothing of it.

_pingvox_commands() { printf '%s\n' map info compare convert render simulate slam locate live emulate bench; }

# What `pingvox bench list` lists.
_pingvox_benches() {
  printf '%s\n' cube-each cube-lazy points-5000 points-50 points-5 tank-2d tank-3d tank-3d-cells tank-fine tank-cone
  printf '%s\n' multibeam lidar-16 lidar-128 rays look-up cast-ray leaves bt-write bt-read memory command realtime live day growth threads log-reading startup
  printf '%s\n' accuracy slam locate paper
  printf '%s\n' paper-{figures,maps,keys,drop,parents,table-1,bytes,rays,bits,smooth,edges,canny}
}

# Prints the long options of a command, one a line.
_pingvox_options() {
  local options=(--help)
  case "$1" in
    "") options+=(--version) ;;
    map)
      options+=(--output --format --json --quiet --progress --strict --topic --fields --config)
      options+=(--resolution --depth --hit --miss --clamp --parents --vote --memory-limit --threads --occupied --free --cut-depth)
      options+=(--poses --nav --nav-source --nav-offset --use-calibration --mount --origin --beam --beam-width --beam-height --device --free-share --ray --hit-from --silent)
      options+=(--min-range --min-bin --max-range --sound-speed --water --filter --kernel --sigma --detect --threshold --cfar --background)
      ;;
    info) options+=(--json --strict --topic --fields) ;;
    compare)
      options+=(--layer --occupied --json --quiet --visible-from --min-range --max-range --beam-height --mount) ;;
    convert)
      options+=(--output --format --strict --topic --fields --quiet --resolution --z --min-z --max-z --height --occupied --free --cut-depth --echoes --nav-source)
      options+=(--min-range --min-bin --max-range --sound-speed --water --filter --kernel --sigma --detect --threshold --cfar --background)
      ;;
    render)
      options+=(--output --view --from --z --min-z --max-z --occupied --free --cut-depth --path --sweep --show --echoes --between --size --caption --beside)
      options+=(--title --strict --topic --fields --quiet --config --resolution --depth --hit --miss --clamp --vote --memory-limit)
      options+=(--poses --nav --nav-source --nav-offset --use-calibration --mount --beam --beam-width --beam-height --device --free-share --ray --hit-from --silent)
      options+=(--min-range --min-bin --max-range --sound-speed --water --filter --kernel --sigma --detect --threshold --cfar --background)
      ;;
    simulate)
      options+=(--output --config --quiet --truth --nav --resolution --side --trajectory --poses --mount --speed --turns --drift)
      options+=(--heading-drift --seed --range --bins --bin-length --beams-per-turn --beam-width --beam-height)
      options+=(--side-lobes --gain --compression --absorption --ringing --speckle --noise --multipath --bubbles --lost)
      options+=(--dvl-noise --dvl-outliers --dvl-lost --dvl-yaw --dvl-scale --compass-deviation --attitude-noise)
      options+=(--gyro-noise --gyro-drift --depth-noise --nav-delay)
      ;;
    slam)
      options+=(--output --map --resolution --calibration --covariance --graph --json --quiet --nav --nav-source --nav-offset --mount --nav-mount --use-calibration --matching)
      options+=(--causal --seed --strict --topic --fields --config --min-range --min-bin --max-range --sound-speed --water)
      options+=(--filter --kernel --sigma --detect --threshold --cfar)
      ;;
    locate)
      options+=(--output --only-sure --map --min-z --max-z --json --quiet --nav --nav-source --nav-offset --mount --nav-mount --use-calibration --odometry --start)
      options+=(--causal --seed --strict --topic --fields --config --min-range --min-bin --max-range --sound-speed --water)
      options+=(--filter --kernel --sigma --detect --threshold --cfar)
      ;;
    live)
      options+=(--output --format --record --write-every --beams --json --quiet --progress --config)
      options+=(--range --sector --step --gain --timeout --nav --obstacles)
      options+=(--resolution --depth --hit --miss --clamp --vote --memory-limit)
      options+=(--mount --beam --beam-width --beam-height --device --free-share --ray --hit-from --silent)
      options+=(--min-range --min-bin --max-range --sound-speed --water --filter --kernel --sigma --detect --threshold --cfar)
      ;;
    emulate) options+=(--listen --to --lost --doubled --damaged --world --trajectory --speed --rate --pings --stall-every --stall --lines --seed) ;;
    bench) options+=(--json --markdown --pictures --quiet) ;;
  esac
  printf '%s\n' "${options[@]}"
}

# _pingvox_words OPTION COMMAND: prints the words that an option takes, one a line; nothing when they are no fixed set.
_pingvox_words() {
  case "$1" in
    --filter) printf '%s\n' none mean median gaussian ;;
    --detect) printf '%s\n' rise level max canny cfar ;;
    --cfar) printf '%s\n' ca so go os ;;
    --beam) printf '%s\n' ray fan cone ;;
    --device) printf '%s\n' ping360 micron miniking seaking-325 seaking-675 ;;
    --matching) printf '%s\n' pairs none ;;
    --ray) printf '%s\n' dda bresenham ;;
    --vote) printf '%s\n' sweep beam ;;
    --hit-from) printf '%s\n' fixed intensity ;;
    --parents) printf '%s\n' max mean ;;
    --silent) printf '%s\n' nothing free ;;
    --trajectory)
      printf '%s\n' still loop
      [[ $2 == emulate ]] || printf '%s\n' line lawn-mower by-hand
      ;;
    --format)
      [[ $2 != convert ]] || echo csv
      printf '%s\n' bt ot pvx
      [[ $2 == live ]] || printf '%s\n' ply pcd xyz
      [[ $2 != convert ]] || printf '%s\n' pgm yaml asc tum
      ;;
    --lines) printf '%s\n' 1 2 ;;
    --gain) [[ $2 != live ]] || printf '%s\n' low normal high ;;
    --world) printf '%s\n' tank harbour seabed cave ;;
    --view) printf '%s\n' polar cartesian above side slice ;;
    --from) printf '%s\n' right left front behind ;;
    --show) printf '%s\n' raw filtered background ;;
    --echoes)
      if [[ $2 == render ]]; then
        printf '%s\n' on off
      else
        printf '%s\n' first all
      fi
      ;;
    --between) printf '%s\n' interpolate nothing ;;
    --height) printf '%s\n' highest lowest ;;
    --progress) printf '%s\n' auto always never ;;
  esac
}

_pingvox() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command="" words="" i
  COMPREPLY=()

  # The first word that is no option is the command.
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} != -* ]]; then
      command=${COMP_WORDS[i]}
      break
    fi
  done

  # --option=word arrives as three words.
  if [[ $current == "=" ]]; then
    current=""
  elif [[ $previous == "=" ]] && ((COMP_CWORD >= 2)); then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  words=$(_pingvox_words "$previous" "$command")

  if [[ -z $words ]]; then
    case "$previous" in
      --resolution | --depth | --mount | --min-range | --min-bin | --max-range | --background | --sound-speed | --water | --kernel | --sigma | --threshold | \
        --nav-mount | --nav-source | --nav-offset | --start | --beam-width | --beam-height | --free-share | --hit | --miss | --clamp | --threads | --memory-limit | --seed | --turns | --side | \
        --beams-per-turn | --bins | --bin-length | --speckle | --noise | --range | --speed | --drift | --heading-drift | \
        --dvl-noise | --dvl-outliers | --dvl-lost | --dvl-yaw | --dvl-scale | --compass-deviation | --attitude-noise | --gyro-noise | \
        --gyro-drift | --depth-noise | --nav-delay | --side-lobes | --gain | --compression | --absorption | --ringing | --multipath | --bubbles | --lost | --size | --sweep | --origin | --layer | --occupied | --free | --cut-depth | --z | --min-z | --max-z | --write-every | --beams | --sector | --step | --timeout | --listen | --to | --obstacles | --doubled | --damaged | --rate | --pings | --stall-every | --stall | --caption | --title | --beside)
        return # a number or a text: nothing to offer
        ;;
    esac
    if [[ $current == -* ]]; then
      words=$(_pingvox_options "$command")
    elif [[ -z $command ]]; then
      words=$(_pingvox_commands)
    elif [[ $command == bench && $previous != --pictures ]]; then
      words="all list $(_pingvox_benches)"
    elif [[ $command == simulate && $previous == simulate ]]; then
      words="tank harbour marina seabed cave"
      # What begins no world's name is the file of a mesh.
      [[ -n $(compgen -W "$words" -- "$current") ]] || words=""
    elif [[ $command == emulate && $previous == emulate ]]; then
      words="ping360 micron mavlink a50"
    fi
  fi

  local IFS=$' \t\n'
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  else
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}

complete -F _pingvox pingvox
