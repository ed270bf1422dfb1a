"""Explicit vectors: eight doubles that go through every operation together.

Inside a compiled function ``load`` and ``store`` move eight neighbours of a flat array, and + - * / work lane by lane.
The compiler uses what the processor has: one instruction of 512 bits, two of 256 or eight of one double, with the same
bits. None of these functions may be called outside compiled code.
"""

import operator
from collections.abc import Callable
from typing import Any, ClassVar

from llvmlite import ir
from numba import float64, types
from numba.core.cgutils import get_or_insert_function
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import models, register_model
from numba.np.arrayobj import make_array

from rubnoise.compiling import inlined, intrinsic

WIDTH = 8

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_INDICES = ir.VectorType(ir.IntType(32), WIDTH)
_DOUBLE_BYTES = 8

Generate = Callable[[Any, Any, Any, Any], Any]


class _LanesType(types.Type):
    """The compiler's name for eight doubles."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


LANES = _LanesType()


@register_model(_LanesType)
class _LanesModel(models.PrimitiveModel):
    """Held in a vector register."""

    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


def _define(operation: Any, instruction: str) -> None:
    class Template(ConcreteTemplate):
        cases: ClassVar = [signature(LANES, LANES, LANES)]

    def lower(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        del context, sig
        return getattr(builder, instruction)(*values)

    infer_global(operation)(Template)
    lower_builtin(operation, LANES, LANES)(lower)


for _operation, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _define(_operation, _instruction)


def _place(context: Any, builder: Any, kind: Any, array: Any, index: Any) -> Any:
    data = make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), _VECTOR.as_pointer())


@intrinsic
def load(typing_context: Any, array: Any, index: Any) -> tuple[Any, Generate]:
    """Return the eight entries of a flat array of doubles from an index on."""

    def generate(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        return builder.load(_place(context, builder, sig.args[0], *values), align=_DOUBLE_BYTES)

    del typing_context, index
    return LANES(array, types.intp), generate


@intrinsic
def store(typing_context: Any, array: Any, index: Any, lanes: Any) -> tuple[Any, Generate]:
    """Put eight doubles into a flat array from an index on."""

    def generate(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        place = _place(context, builder, sig.args[0], *values[:2])
        builder.store(values[2], place, align=_DOUBLE_BYTES)
        return context.get_dummy_value()

    del typing_context, index, lanes
    return types.void(array, types.intp, LANES), generate


def _shuffled(builder: Any, first: Any, second: Any, indices: list[int]) -> Any:
    return builder.shuffle_vector(first, second, ir.Constant(_INDICES, indices))


@intrinsic
def spread(typing_context: Any, number: Any) -> tuple[Any, Generate]:
    """Return the number in every lane."""

    def generate(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        del context, sig
        empty = ir.Constant(_VECTOR, ir.Undefined)
        one = builder.insert_element(empty, values[0], ir.Constant(ir.IntType(32), 0))
        return _shuffled(builder, one, empty, [0] * WIDTH)

    del typing_context, number
    return LANES(float64), generate


def _instruction_of(name: str, operands: int) -> Any:
    def typed(typing_context: Any, *lanes: Any) -> tuple[Any, Generate]:
        def generate(context: Any, builder: Any, sig: Any, values: Any) -> Any:
            del context, sig
            kind = ir.FunctionType(_VECTOR, [_VECTOR] * operands)
            return builder.call(get_or_insert_function(builder.module, kind, f"llvm.{name}.v{WIDTH}f64"), values)

        del typing_context, lanes
        return LANES(*[LANES] * operands), generate

    return typed


@intrinsic
def fused(typing_context: Any, factor: Any, other: Any, term: Any) -> tuple[Any, Generate]:
    """Return factor * other + term, rounded once."""
    generator: tuple[Any, Generate] = _instruction_of("fma", 3)(typing_context, factor, other, term)
    return generator


@intrinsic
def root(typing_context: Any, lanes: Any) -> tuple[Any, Generate]:
    """Return the square roots."""
    generator: tuple[Any, Generate] = _instruction_of("sqrt", 1)(typing_context, lanes)
    return generator


def _chosen(typing_context: Any, one: Any, other: Any, comparison: str) -> tuple[Any, Generate]:
    def generate(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        del context, sig
        return builder.select(builder.fcmp_ordered(comparison, *values), *values)

    del typing_context, one, other
    return LANES(LANES, LANES), generate


@intrinsic
def smaller(typing_context: Any, one: Any, other: Any) -> tuple[Any, Generate]:
    """Return the smaller of each pair."""
    return _chosen(typing_context, one, other, "<")


@intrinsic
def larger(typing_context: Any, one: Any, other: Any) -> tuple[Any, Generate]:
    """Return the larger of each pair."""
    return _chosen(typing_context, one, other, ">")


@intrinsic
def where_above(typing_context: Any, low: Any, high: Any, yes: Any, no: Any) -> tuple[Any, Generate]:
    """Return ``yes`` if high lies above low, else ``no``."""

    def generate(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        del context, sig
        return builder.select(builder.fcmp_ordered("<", *values[:2]), *values[2:])

    del typing_context, low, high, yes, no
    return LANES(LANES, LANES, LANES, LANES), generate


@inlined
def polynomial(coefficients: tuple[float, ...], x: Any) -> Any:
    """Return c_0 + c_1 x + ... in every lane, by Horner's rule."""
    value = spread(coefficients[-1])
    for n in range(len(coefficients) - 2, -1, -1):
        value = fused(value, x, spread(coefficients[n]))
    return value
