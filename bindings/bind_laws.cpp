// SPDX-License-Identifier: Apache-2.0
#include "batch_view.h"
#include "law_argument.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::bindings {

namespace {

constexpr const char* law_doc = "A law of force for any number of bonds; made by `System.law`.";

constexpr const char* make_law_doc =
    "A new law of force for any number of bonds. Parameters are keywords with their default\n"
    "values; None is the distance of the two ends when a bond is made.\n\n"
    "law is one of\n"
    "- an expression of r (distance, m), v = dr/dt, t, m_p, m_q and the parameters, which defines `energy` (J), `force`\n"
    "  (N along the line, positive pushes apart) or `drag` (N s/m, times the velocity difference): implicit, any stiffness\n"
    "  is stable; the energy of a pairwise force may depend on normals too (cos_p, cos_q, cos_pq, see docs/forces.md);\n"
    "- compiled code: a Numba cfunc, a ctypes function or an address, of signature 'radial',\n"
    "  double f(double r, double v, double t, const double* parameters), or 'batch', see docs/forces.md;\n"
    "- a function of NumPy arrays, called once a step with a BondBatch of all its bonds; it returns the forces on p,\n"
    "  shape (n, 3), N.\n"
    "Code is evaluated once a step and held.\n\n"
    "    law = system.law('energy = 0.5*k*(r - r0)^2; force = -c*v', k=100, r0=None, c=1)\n"
    "    bond = system.bond(p, q, law, k=200)";

constexpr const char* bond_batch_doc =
    "The argument of a law's function: arrays with a row for each bond, in the order of `bonds`. Valid only until\n"
    "the function returns; the arrays are copies and may be kept.";

struct BondsView : BatchView<BondBatch> {
  LawId law;

  const BondBatch& use() const { return BatchView::use("BondBatch"); }
};

double distance_of(const BondBatch& b, std::size_t i) {
  const double *p = b.position_p + 3 * i, *q = b.position_q + 3 * i;
  return norm(Vec3{q[0] - p[0], q[1] - p[1], q[2] - p[2]});
}

void bind_bond_batch(nb::module_& module) {
  nb::class_<BondsView> type(module, "BondBatch", bond_batch_doc);
  const auto def_rows = [&](const char* name, const double* BondBatch::* rows, const char* text) {
    type.def_prop_ro(
        name, [rows](const BondsView& self) { return copy_rows(self.use().*rows, self.use().count); },
        nb::sig((std::string("def ") + name + "(self) -> numpy.typing.NDArray[numpy.float64]").c_str()), text);
  };
  def_rows("position_p", &BondBatch::position_p, "(n, 3), m, in the middle of the step in the energy-keeping mode.");
  def_rows("position_q", &BondBatch::position_q, "(n, 3), m.");
  def_rows("velocity_p", &BondBatch::velocity_p, "(n, 3), m/s, at the start of the step.");
  def_rows("velocity_q", &BondBatch::velocity_q, "(n, 3), m/s.");
  type.def("__len__", [](const BondsView& self) { return self.use().count; })
      .def_prop_ro(
          "time", [](const BondsView& self) { return self.use().time; },
          "Of the positions, s: at the start of the step in the robust mode, else in its middle.")
      .def_prop_ro(
          "distance",
          [](const BondsView& self) {
            const BondBatch& b = self.use();
            std::vector<double> numbers(b.count);
            for (std::size_t i = 0; i < b.count; ++i) numbers[i] = distance_of(b, i);
            return make_array(std::move(numbers));
          },
          nb::sig("def distance(self) -> numpy.typing.NDArray[numpy.float64]"), "(n,), m.")
      .def_prop_ro(
          "direction",
          [](const BondsView& self) {
            const BondBatch& b = self.use();
            std::vector<double> numbers(3 * b.count);
            for (std::size_t i = 0; i < numbers.size(); ++i) {
              const double length = distance_of(b, i / 3);
              numbers[i] = length > 0 ? (b.position_q[i] - b.position_p[i]) / length : 0;
            }
            return nb::cast(make_vector3_array(std::move(numbers)));
          },
          nb::sig("def direction(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, 3), unit vectors from p to q; zero if they coincide.")
      .def_prop_ro(
          "parameters",
          [](const BondsView& self) {
            const BondBatch& b = self.use();
            const auto names = self.system->engine.laws().parameters(self.law);
            nb::dict all;
            for (std::size_t k = 0; k < names.size(); ++k) {
              std::vector<double> column(b.count);
              for (std::size_t i = 0; i < b.count; ++i) column[i] = b.parameters[i * names.size() + k];
              all[names[k].name.c_str()] = make_array(std::move(column));
            }
            return all;
          },
          nb::sig("def parameters(self) -> dict[str, numpy.typing.NDArray[numpy.float64]]"),
          "By name, an array (n,) each.")
      .def_prop_ro(
          "bonds",
          [](const BondsView& self) {
            const BondBatch& b = self.use();
            return wrap_all<BondHandle>(self.system_object, self.system, std::span(b.bonds, b.count));
          },
          "The bonds.");
}

BatchFunction make_batch_function(SystemObject* system, std::shared_ptr<ScriptFunction> function,
                                  std::shared_ptr<LawId> law) {
  return [system, function = std::move(function), law = std::move(law)](const BondBatch& batch) {
    ask_for_forces(function, BondsView{{{}, system, &batch}, *law}, "bond");
  };
}

using BatchCode = void (*)(std::int64_t count, double t, const double* position_p, const double* position_q,
                           const double* velocity_p, const double* velocity_q, const double* parameters, double* force);

LawBody code_at(std::uintptr_t address, const std::string& signature) {
  if (signature == "radial") return reinterpret_cast<RadialFunction>(address);
  if (signature != "batch") {
    const std::string text = "signature must be 'radial' or 'batch', not '" + signature + "'";
    throw nb::value_error(text.c_str());
  }
  return BatchFunction([code = reinterpret_cast<BatchCode>(address)](const BondBatch& b) {
    code(static_cast<std::int64_t>(b.count), b.time, b.position_p, b.position_q, b.velocity_p, b.velocity_q,
         b.parameters, b.force);
  });
}

LawHandle make_law(nb::handle_t<SystemObject> self, nb::object law, const std::string& name,
                   const std::string& signature, const nb::kwargs& parameters) {
  SystemObject* system = nb::inst_ptr<SystemObject>(self);
  System& engine = system->use_between_steps("law(...)");
  LawOptions options{name, to_parameters(parameters)};
  LawId id;
  if (nb::isinstance<nb::str>(law)) {
    const std::string text = nb::cast<std::string>(law);
    if (text.find('=') == std::string::npos && options.parameters.empty())
      id = engine.laws().find(text);
    else
      id = engine.laws().create(text, options);
  } else if (const std::uintptr_t address = address_of(law)) {
    if (name.empty()) options.name = function_name(law).substr(0, 31);
    id = engine.laws().create(code_at(address, signature), options);
    system->code.push_back(law);
  } else if (PyCallable_Check(law.ptr())) {
    if (name.empty()) options.name = function_name(law).substr(0, 31);
    auto function = std::make_shared<ScriptFunction>(ScriptFunction{law, "law " + options.name});
    auto own_id = std::make_shared<LawId>();
    system->keep(function);
    id = engine.laws().create(make_batch_function(system, function, own_id), options);
    *own_id = id;
  } else {
    throw nb::type_error(
        ("law must be an expression, compiled code or a function of arrays, not " + describe(law)).c_str());
  }
  return handle_of(self, id);
}

}  // namespace

std::string function_name(nb::handle function) {
  nb::object name = nb::getattr(function, "__qualname__", nb::none());
  return name.is_none() ? nb::type_name(function.type()).c_str() : nb::str(name).c_str();
}

std::uintptr_t address_of(nb::handle code) {
  if (PyLong_Check(code.ptr()) && !PyBool_Check(code.ptr())) {
    std::uintptr_t address = 0;
    // No code has a small address: a small number is a mistake.
    return nb::try_cast<std::uintptr_t>(code, address) && address >= 0x10000 ? address : 0;
  }
  if (nb::hasattr(code, "address")) return nb::cast<std::uintptr_t>(code.attr("address"));
  nb::object ctypes = nb::module_::import_("ctypes");
  if (!nb::isinstance(code, ctypes.attr("_CFuncPtr"))) return 0;
  return nb::cast<std::uintptr_t>(ctypes.attr("cast")(code, ctypes.attr("c_void_p")).attr("value"));
}

std::vector<LawParameter> to_parameters(const nb::kwargs& arguments) {
  std::vector<LawParameter> list;
  for (const auto& [key, value] : arguments) {
    const std::string name = nb::cast<std::string>(key);
    double number = std::numeric_limits<double>::quiet_NaN();
    if (!value.is_none()) {
      if (!nb::try_cast<double>(value, number)) {
        const std::string text = name + " must be a number, not " + describe(nb::handle(value));
        throw nb::type_error(text.c_str());
      }
      finite(number, name.c_str());
    }
    list.push_back({name, number});
  }
  return list;
}

nb::dict to_dict(const std::vector<LawParameter>& parameters) {
  nb::dict all;
  for (const LawParameter& p : parameters)
    all[p.name.c_str()] = std::isnan(p.value) ? nb::object(nb::none()) : nb::object(nb::float_(p.value));
  return all;
}

LawId law_of_text(SystemObject& system, const std::string& text, const std::vector<LawParameter>& parameters) {
  if (text.find('=') == std::string::npos) return system.engine.laws().find(text);
  std::string key = text;
  for (const LawParameter& p : parameters) key += '\n' + p.name;
  // A restore may have removed the law, or put another in its slot.
  const auto known = system.written_laws.find(key);
  if (known != system.written_laws.end() && system.engine.laws().contains(known->second) &&
      system.engine.laws().expression(known->second) == text) {
    const auto theirs = system.engine.laws().parameters(known->second);
    if (std::equal(theirs.begin(), theirs.end(), parameters.begin(), parameters.end(),
                   [](const auto& a, const auto& b) { return a.name == b.name; }))
      return known->second;
  }
  return system.written_laws[key] = system.engine.laws().create(text, {"", parameters});
}

void bind_laws(nb::module_& module) {
  bind_bond_batch(module);
  nb::class_<LawHandle> type(module, "Law", law_doc, nb::type_slots(handle_slots<LawHandle>),
                             nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def("law", &make_law, "law"_a, nb::kw_only(), "name"_a = "", "signature"_a = "radial", "parameters"_a,
           nb::sig("def law(self, law: str | int | collections.abc.Callable[[BondBatch], "
                   "numpy.typing.ArrayLike] | object, *, name: str = '', signature: str = 'radial', "
                   "**parameters: float | None) -> Law"),
           make_law_doc);
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const LawHandle& self) { return self.is_alive(); }, "False once it was destroyed.")
      .def_prop_ro("name", [](const LawHandle& self) { return self.use().laws().name(self.id); })
      .def_prop_ro(
          "kind", [](const LawHandle& self) { return self.use().laws().kind(self.id); },
          nb::sig("def kind(self) -> typing.Literal['predefined', 'expression', 'function', 'compiled', 'arrays']"),
          "Its kind; 'function': a function for one bond.")
      .def_prop_ro(
          "text", [](const LawHandle& self) { return self.use().laws().expression(self.id); },
          "The expression; empty for code.")
      .def_prop_ro(
          "parameters", [](const LawHandle& self) { return to_dict(self.use().laws().parameters(self.id)); },
          nb::sig("def parameters(self) -> dict[str, float | None]"),
          "The default values; None is the distance of the ends.")
      .def(
          "destroy", [](const LawHandle& self) { self.use().laws().destroy(self.id); },
          "Removes it. Raises ValueError if bonds use it, and for a predefined law.")
      .def("__repr__", [](const LawHandle& self) {
        if (!self.is_alive()) return stale_repr("Law", self);
        const std::string name = self.system->engine.laws().name(self.id),
                          text = self.system->engine.laws().expression(self.id);
        return "<Law " + std::to_string(self.id.slot) + (name.empty() ? "" : " " + name) +
               (text.empty() ? "" : ": " + text) + ">";
      });
}

}  // namespace iota::bindings
