#!/bin/sh
# Runs a firmware image: `run.sh ELF [ARGUMENT...]`. Both boards share one target triple, so cargo cannot tell them
# apart; the name of the image can.
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
    echo "setpoint link: $links/setpoint.sock, configuration link: $links/config.sock, log: $links/log.defmt" >&2
    exec qemu-system-arm -M mps2-an500,memory-backend=psram \
        -object "memory-backend-file,id=psram,size=16M,mem-path=$links/psram,share=on" \
        -display none -monitor none \
        -chardev "socket,id=setpoint,path=$links/setpoint.sock,server=on,wait=off" -serial chardev:setpoint \
        -chardev "socket,id=config,path=$links/config.sock,server=on,wait=off" -serial chardev:config \
        -serial null -serial "file:$links/log.defmt" -kernel "$elf" "$@" ;;
esac
