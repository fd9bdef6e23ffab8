#!/usr/bin/env bash
# Puts kernels of other people, whose cycles were measured on hardware and published, through
# `vm cycles`, and prints how far its typical setting is off. Fails where that is more than 3 %.
#
# Needs git, the network and arm-none-eabi-as and -ld (apt-get install binutils-arm-none-eabi);
# nothing of the kernels' code is kept.
#
# Published: All the AES You Need on Cortex-M3 and M4 (Schwabe, Stoffelen), STM32F407, table in
# the README of Ko-/aes-armcortexm; README of Emill/X25519-Cortex-M4.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cargo build --quiet --release --bin vm

fetch() { # owner/name commit
    git init --quiet "$work/$1"
    git -C "$work/$1" fetch --quiet --depth 1 "${GITHUB:-https://github.com}/$1" "$2"
    git -C "$work/$1" checkout --quiet FETCH_HEAD
}

link() { # source image
    arm-none-eabi-as -mcpu=cortex-m4 -mthumb "$work/$1" -o "$work/$2.o"
    arm-none-eabi-ld -Ttext 0x08000000 -e 0 "$work/$2.o" -o "$work/$2.elf"
}

compare() { # published image symbol arguments...
    local published=$1 image=$2 symbol=$3
    shift 3
    local typical
    typical=$(target/release/vm cycles --elf "$work/$image.elf" --symbol "$symbol" --entry "$@" |
        awk '$2 == "typical" { print $8 }')
    awk -v m="$typical" -v p="$published" -v s="$symbol" 'BEGIN {
        off = 100 * (m - p) / p
        printf "%-22s %10.1f %10.1f %+6.1f %%\n", s, p, m, off
        exit off < -3 || off > 3
    }'
}

fetch Ko-/aes-armcortexm bed63794d09008bc62e9a69614077acbf10746a1
fetch Emill/X25519-Cortex-M4 e85f816701fa7b908d3442398a7c8ff1741c4fe6
link Ko-/aes-armcortexm/aes128/aes.s aes
link Ko-/aes-armcortexm/aes128ctrbs/aes_128_ctr_bs.s bitsliced
link Emill/X25519-Cortex-M4/x25519-cortex-m4-gcc.s x25519

printf '%-22s %10s %10s %8s\n' kernel published typical off
key=bytes:000102030405060708090a0b0c0d0e0f
secret=${key}101112131415161718191a1b1c1d1e1f
compare 244.9 aes AES_128_keyschedule $key zeros:176
compare 634.7 aes AES_128_encrypt zeros:176 zeros:16 zeros:16
compare 1021.9 bitsliced AES_128_keyschedule $key zeros:352
# 256 blocks at 1616.6 each.
compare 413849.6 bitsliced AES_128_encrypt_ctr zeros:368 zeros:4096 zeros:4096 4096
compare 548873 x25519 curve25519_scalarmult zeros:32 $secret $secret
