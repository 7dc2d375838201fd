"""KTX2 files of Basis Universal, and the picture that all of them hold.

Made with the encoder of basis_universal 2.50: ETC1S, UASTC without
supercompression and in Zstandard's, with five levels and with one. All have
16 x 8 pixels, blocks of 4 x 4 of one colour each.
"""

from base64 import b85decode
from typing import Any

import numpy as np

__all__ = ["FILES", "KTX2_PICTURE", "ktx2_file"]


def _picture() -> np.ndarray[Any, Any]:
    row, column = np.mgrid[0:2, 0:4]
    channels = [
        40 + 50 * column,
        200 - 60 * row,
        240 - 50 * column + 10 * row,
        255 - 40 * column - 60 * row,
    ]
    blocks = np.stack(channels, axis=-1).astype(np.uint8)
    return blocks.repeat(4, axis=0).repeat(4, axis=1)


# (8, 16, 4) of uint8; alpha is that of the files which have one.
KTX2_PICTURE = _picture()

_ENCODED = {
    "etc1s": (
        "t4mZ^ATlt!4GJ0x000000RR915C8xG2mk;800000000000RR911poj50RR91$N&HUE"
        "C2ui^Z)<=Bme*a7y$qP000002LS*800000Bmw{c000001poj5000000000000000A_"
        "4#a000000ssI2000000000000000Ap!sZ000000RR91000000000000000AOZjY000"
        "000RR910000000000000009|8aX000000RR91000000000000000EC2ui000000str"
        "gqX7Z{0|Nj62mk;800000002J#0000000000|NsC09{>OVOH^2Qa%psBasWbMb7^xR"
        "Rc>i^WpZ<2Y#=f&F)#oC4FCoJMF0Q*82|tPF#rGn0000000000000001poj5000000"
        "000000000000000ssI2000000000000000000000RR91000000000000000000000R"
        "R91000000000000000000000RR9100000000004ZsWl000000CI{4@CHBt03et~%Oj"
        ";ciw_`ffB*o1Ff0!^2o4fx5r8QG0ssI2AV@l~Ss)@J^Mi?|#I@0KRPM-M08~{408mv"
        "`RsH|}|JR3tf}*0Lq5=Q_0002NL;wH)0002;U#$U{0x$poAPB&Ga{vnPMt}eSK**&s"
        "8a;skU;+RD000000R#XBda|AfZUhr3dj"
    ),
    "etc1s alpha": (
        "t4mZ^ATlt!4GJ0x000000RR915C8xG2mk;800000000000RR910RR910RR91XaE2JJ"
        "OBUyqyPW_Bme*a$N&HU00000w*UYD00000e*pjh000002><{9000000000000000JO"
        "BUy000000suGwqX7W`0|Nj62nYZG00000002J#0000000000|NsC0Kmb1v00000000"
        "00|NsC09{>OVOH^2Qa%psBasWbMb7^xRRc>i^WpZ<2Y#=f&F)#oC5C8-KO#lD@5dZ)"
        "HF#rGn0000000000000001poj51poj51ONa43BVKp0RR910J0Ph;0=HP0D>?`VtCZy"
        "A-GKtAPT?$0DvHDCX-o(Zy*3u00000fB;Yo==|iN>}EPwdr0g)WA&>_8W7tDz&4VV1"
        "XNX3RsH|}|F5d5ssaE20002NL;wH)0002;Uo8Qc0ssI2004pX6ajGq2mk<vfG7D<X#"
        "}GP044wc000005I_KWP(X+Q9yk>O"
    ),
    "uastc alpha zstandard": (
        "t4mZ^ATlt!4GJ0x000000RR915C8xG2mk;800000000000RR911poj50ssI2$N&HUE"
        "C2ui^Z)<=Bme*a00000000000000000000i~#@u00000TL1t600000fB*mh00000V*"
        "vmF00000DF6Tf00000AOHXW00000N&x@>0000082|tP000005C8xG00000F#!Mo000"
        "0082|tP000005C8xG000007y$qP0000082|tP000005C8xG00000EC2ui000000str"
        "grU3x}0|Nj65C8xG00000004gj0000000000|NsC09{>OVOH^2Qa%psBasWbMb7^xR"
        "Rc>i^WpZ<2Y#=f&F)#oCD77#BAP|870C!GRwKRkG0ssI20000004TLD{U8v5003=(7"
        "9>Qfs=A%W?C0m_=LaaYFa018fdBwNQj6M9o(C5bGMKuUx|q5swJ-f3AOQgYPe>)yq7"
        "a`u<(OT6p`iPE4-(S_5Wg^+cE9R2wklOsD77#BAb^zu0K@|q1sVQ79d-i%R}0zqx;="
        "CPml2uqHGTF0*B4pqu$}Y(7ll!Ocpi_75qYycjgirEZhj8}myv8Kz_I}dAaJ9F1H>q"
        "%T?X3_KEfyAnK%L"
    ),
    "uastc zstandard": (
        "t4mZ^ATlt!4GJ0x000000RR915C8xG2mk;800000000000RR910RR910ssI2XaE2JE"
        "C2uilmGw#Bme*a00000000000000000000xBvhE00000TL1t600000fB*mh00000EC"
        "2ui000000strgrU3!~0|Nj65C8xG00000004gg0000000000|NsC09{>OVOH^2Qa%p"
        "sBasWbMb7^xRRc>i^WpZ<2Y#=f&F)#oCD77#BAb^zu0K@|q1sVQ79d-i%R}0zqzddv"
        "Uml2uqKYjKA*B4pqzn$~|7ll#(e;$vE5&6G8jgisve|`@Fmyzs0z_I}dAaJ9F1H>q%"
        "T?X3_KEfyAnK%L"
    ),
    "uastc": (
        "t4mZ^ATlt!4GJ0x000000RR915C8xG2mk;800000000000RR910RR9100000XaE2JE"
        "C2uilmGw#Bme*a00000000000000000000zyJUM00000fB*mh00000fB*mh00000EC"
        "2ui000000strgrU3!~0|Nj65C8xG00000004gg0000000000|NsC09{>OVOH^2Qa%p"
        "sBasWbMb7^xRRc>i^WpZ<2Y#=f&F)#oC00000000007X=yqKOJ@h0000000000R}0z"
        "qzddvU0000000000ml2uqKYjKA0000000000*B4pqzn$~|00000000007ll#(e;$tm"
        "0000000000SBnw(zdelt0000000000myyx(e|`@F0000000000*O!s(Kftm9000000"
        "0000"
    ),
}

FILES = tuple(_ENCODED)


def ktx2_file(name: str) -> bytes:
    """The bytes of the file called ``name``, one of FILES."""
    return b85decode(_ENCODED[name])
