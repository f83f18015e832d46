#!/bin/sh
# Runs a firmware image: `run.sh ELF [ARGUMENT...]`. Both boards share one target triple, so cargo cannot tell them
# apart; the name of the image can. The links of the virtual board are sockets in $TRUEPATH_LINKS; with
# TRUEPATH_SERIAL=1 they are serial ports (pseudo terminals), for a controller that knows nothing else, and the
# names there are links to them.
set -eu
elf=$1
shift
case "$(basename "$elf")" in
*nucleo-h743*) exec probe-rs run --chip STM32H743ZITx "$@" "$elf" ;;
*budget*)
    exec qemu-system-arm -M mps2-an500 -display none -monitor none -no-reboot -icount shift=10,sleep=off \
        -serial stdio -serial null -serial null -serial null -kernel "$elf" "$@" ;;
*)
    links=${TRUEPATH_LINKS:-$(dirname "$elf")/links}
    mkdir -p "$links"
    truncate -s 16M "$links/psram"
    board() {
        setpoint=$1
        config=$2
        shift 2
        exec qemu-system-arm -M mps2-an500,memory-backend=psram \
            -object "memory-backend-file,id=psram,size=16M,mem-path=$links/psram,share=on" \
            -display none -monitor none \
            -chardev "$setpoint" -serial chardev:setpoint -chardev "$config" -serial chardev:config \
            -serial null -serial "file:$links/log.defmt" -kernel "$elf" "$@"
    }
    if [ -n "${TRUEPATH_SERIAL:-}" ]; then
        rm -f "$links/setpoint" "$links/config"
        # QEMU says which terminal each link got: `char device redirected to /dev/pts/3 (label setpoint)`.
        board pty,id=setpoint pty,id=config "$@" | while read -r said; do
            case $said in
            *" redirected to "*"(label "*)
                port=${said#* redirected to }
                label=${said#*(label }
                label=${label%)*}
                ln -sf "${port%% *}" "$links/$label"
                echo "$label link: $links/$label, ${port%% *}" >&2 ;;
            *) echo "$said" >&2 ;;
            esac
        done
    else
        echo "setpoint link: $links/setpoint.sock, configuration link: $links/config.sock, log: $links/log.defmt" >&2
        board "socket,id=setpoint,path=$links/setpoint.sock,server=on,wait=off" \
            "socket,id=config,path=$links/config.sock,server=on,wait=off" "$@"
    fi ;;
esac
