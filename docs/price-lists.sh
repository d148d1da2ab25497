#!/bin/sh
# Renews docs/price-lists.md and its pictures: a coarse study of each shipped scene that has a reference. `make prices`
# calls it with the program; further arguments are the scenes to renew, of the others the page keeps what it has.
# Finished runs in out/prices are used again.
set -eu
cd "$(dirname "$0")/.."
program=$1
shift
lists=out/prices
page=docs/price-lists.md
mkdir -p "$lists"

# SCENE's list by a study with these arguments; the page shows the command as the second argument has it.
write_list() {
    scene=$1
    command=$2
    shift 2
    echo "$scene"
    "$program" study "$@" --out "$lists/$scene" > "$lists/$scene.new"
    printf '%s' "halfstep study $command" > "$lists/$scene.command"
    model=$(sed -n 's/^model name[[:space:]]*: //p' /proc/cpuinfo | head -n 1)
    waiting=$(cut -d ' ' -f 2 /proc/loadavg)
    printf '%s' "$(date +%F), ${model:-unknown}, $(nproc) processors, $waiting programs waiting for them at the end." \
        > "$lists/$scene.when"
    cp "$lists/$scene/work-precision.png" "docs/images/price-$scene.png"
    # A list is whole or not there.
    mv "$lists/$scene.new" "$lists/$scene.txt"
}

is_wanted() {
    case " $wanted " in *" $1 "*) ;; *) return 1 ;; esac
}

price() {
    is_wanted "$1" || return 0
    own=scenes/$1.toml
    name=$1
    shift
    write_list "$name" "$own $*" "$own" "$@"
}

# A scene of an example in Python: name, example, scene and script in its folder with the script's arguments.
price_example() {
    is_wanted "$1" || return 0
    name=$1
    folder=python/examples/$2
    own=$folder/$3.toml
    # What the tests' environment has needs none of its own.
    case $2 in
        mujoco | scikit-fem) python=$(sh tests/python/setup.sh) ;;
        *) python=$(sh tests/python/setup.sh "$2") ;;
    esac
    script=$folder/$4
    shift 4
    line="OMP_NUM_THREADS=1 python3 $script"
    write_list "$name" "$own --solid '$line' $*" "$own" --solid "OMP_NUM_THREADS=1 $python $PWD/$script" "$@"
}

all="oscillating-plate hydrostatic-tank taylor-green lid-driven-cavity standing-wave dam-break hydrostatic-plate"
all="$all elastic-gate breaking-wall wave-paddle solitary-wave-wall floating-box block-wall gate-lift rolling-tank"
all="$all mujoco-box mujoco-flap mujoco-wave-flap pyelastica-stem"
wanted=${*:-$all}
price oscillating-plate --until 0.4 --set resolution=0.004 \
    --vary resolution=0.002,0.0028571428571428571,0.0066666666666666667 \
    --vary solid.model=hypoelastic --vary solid.material=st-venant-kirchhoff --vary solid.hourglass=0.1 \
    --vary effects.clamp-face=off --vary solid.smoothing_ratio=1.33 --vary numerics.solid_cfl=0.3,0.9
price hydrostatic-tank --set resolution=0.02 --vary resolution=0.015,0.03 \
    --vary numerics.precision=mixed --vary fluid.time_integration=midpoint \
    --vary fluid.density_diffusion=delta-sph,simple,none \
    --vary fluid.artificial_viscosity.linear=1 --vary smoothing_ratio=1.5 --vary numerics.cfl=0.3
price taylor-green --vary resolution=0.025,0.04,0.05 --vary numerics.kernel=cubic-spline \
    --vary numerics.precision=mixed --vary fluid.time_integration=midpoint \
    --vary smoothing_ratio=1.5,2.4 --vary effects.particle-shifting=off \
    --vary fluid.density_diffusion=delta-sph,none --vary numerics.cfl=0.3
price lid-driven-cavity --vary resolution=0.0285714285714285714,0.04 \
    --vary numerics.precision=mixed --vary fluid.time_integration=midpoint --vary smoothing_ratio=1.5 \
    --vary effects.no-slip-continuity=off --vary effects.particle-shifting=off --vary fluid.sound_speed=20
price standing-wave --set resolution=0.025 --vary resolution=0.0357142857142857143,0.05 \
    --vary numerics.precision=mixed --vary fluid.time_integration=midpoint \
    --vary numerics.kernel=cubic-spline \
    --vary smoothing_ratio=1.5,2.4 --vary effects.particle-shifting=off --vary fluid.density_diffusion=delta-sph
price dam-break --set resolution=0.0028575 --vary resolution=0.00408214285714285714,0.005715 \
    --vary numerics.precision=mixed --vary fluid.time_integration=midpoint \
    --vary numerics.cfl=0.3,0.9 --vary smoothing_ratio=1.5 --vary effects.particle-shifting=off \
    --vary numerics.kernel=cubic-spline --vary fluid.density_diffusion=delta-sph,none
price hydrostatic-plate --until 0.25 --set resolution=0.01666666666666666667 --vary resolution=0.0125,0.025 \
    --vary solid.model=hypoelastic --vary fluid.density_diffusion=delta-sph,simple \
    --vary fluid.time_integration=verlet
price elastic-gate --until 0.25 --set resolution=0.00166666666666666667 --set shape.plate.across=5 \
    --vary numerics.precision=mixed --vary fluid.time_integration=verlet \
    --vary resolution=0.00125,0.0025 --vary shape.plate.across=3,4 \
    --vary solid.model=hypoelastic,finite-element --vary solid.sub_steps=20 \
    --vary numerics.cfl=0.2,0.6 \
    --vary numerics.kernel=cubic-spline --vary fluid.density_diffusion=delta-sph,simple \
    --vary fluid.artificial_viscosity.linear=0.02 --vary smoothing_ratio=2
# The wall goes as deep into the floor as it is thick: whole rows of every spacing, above the floor, too.
price breaking-wall --until 0.2 --set resolution=0.004 --set 'shape.wall.box.min=[0.286,-0.012]' \
    --vary resolution=0.0024,0.003 --vary numerics.cfl=0.2 \
    --vary fluid.time_integration=verlet
# A piston as thick as the widest kernel reaches: water would get past it.
price wave-paddle --set resolution=0.02 --set 'shape.paddle.box.min=[-0.16,0.0]' \
    --vary resolution=0.0133333333333333333,0.04 --vary smoothing_ratio=1.5 --vary effects.particle-shifting=off \
    --vary fluid.time_integration=midpoint
price solitary-wave-wall --set resolution=0.02 --set 'shape.piston.box.min=[-0.16,0.0]' \
    --vary resolution=0.01,0.04 --vary smoothing_ratio=1.5 --vary fluid.density_diffusion=delta-sph \
    --vary fluid.time_integration=midpoint
price floating-box --set resolution=0.0125 --vary resolution=0.01,0.02 --vary smoothing_ratio=2 \
    --vary interface.cross_viscosity_reach=1.25 --vary effects.particle-shifting=off \
    --vary fluid.time_integration=midpoint
price block-wall --until 0.4 --set resolution=0.02 --vary resolution=0.01,0.005 --vary effects.particle-shifting=off
price gate-lift --until 0.45 --set resolution=0.002 --vary resolution=0.0016 --vary shape.plate.across=3,5 \
    --vary solid.model=total-lagrangian \
    --vary fluid.time_integration=verlet
price rolling-tank --until 1.0 --set resolution=0.002 --vary resolution=0.0013333333333333333 \
    --vary solid.model=finite-element
price_example mujoco-box mujoco floating-box floating_box.py \
    --set resolution=0.0125 --vary resolution=0.01,0.01666666666666667 --vary smoothing_ratio=2 --vary numerics.cfl=0.2
price_example mujoco-flap mujoco hinged-flap 'hinged_flap.py 40 1' \
    --set resolution=0.005 --vary resolution=0.0033333333333333333,0.01 --vary smoothing_ratio=2 --vary numerics.cfl=0.2
price_example mujoco-wave-flap mujoco wave-flap 'wave_flap.py 5.5 0' \
    --set resolution=0.01 --set 'shape.paddle.box.min=[-0.06,0.0]' \
    --vary resolution=0.00666666666666666667 --vary numerics.cfl=0.2
price_example pyelastica-stem pyelastica stem stem.py \
    --until 3.2 --set resolution=0.01 --set 'shape.paddle.box.min=[-0.06,0.0]' \
    --vary resolution=0.00666666666666666667 --vary numerics.cfl=0.2

{
    cat <<'HEAD'
# Price lists

What accuracy costs in the shipped scenes: coarse ladders that a small machine runs in minutes. [Studies](study.md)
explains every number. Errors and pair evaluations do not depend on what else the machine does; wall times do, and where
more programs waited than there are processors they say little: compare pair evaluations. These hang on the
[instruction set level](study.md#the-numbers) and on the precision: lists of 2026-11-26 that name an Intel processor are
of AVX-512, and AVX2, which runs take there now, has 1.15 to 1.3 times fewer pairs in the same steps.

Renewed by `make prices`, which runs the commands below; do not edit.
HEAD
    for scene in $all; do
        case " $wanted " in *" $scene "*) ;; *)
            awk -v head="## $scene" '/^## / { here = $0 == head; if (here) print "" } here' "$page" |
                sed -e :a -e '/^\n*$/{$d;N;ba' -e '}'
            continue
            ;;
        esac
        printf '\n## %s\n\n%s\n\n' "$scene" "$(cat "$lists/$scene.when")"
        printf '```\n%s\n```\n\n```\n' "$(cat "$lists/$scene.command")"
        grep -v '^study.csv' "$lists/$scene.txt" | sed -e :a -e '/^\n*$/{$d;N;ba' -e '}'
        printf '```\n\n![%s: error over cost](images/price-%s.png)\n' "$scene" "$scene"
    done
} > "$lists/page.md"
mv "$lists/page.md" "$page"
