#include "occt/faults.h"

#include <BRepCheck.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepCheck_ListOfStatus.hxx>
#include <BRepCheck_Result.hxx>
#include <TopAbs.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace softfold::occt {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// BRepCheck's own words, "BRepCheck_SelfIntersectingWire" for example.
std::string words(BRepCheck_Status status) {
  std::ostringstream out;
  BRepCheck::Print(status, out);
  std::string text = out.str();
  text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());
  const std::string prefix = "BRepCheck_";
  return text.rfind(prefix, 0) == 0 ? text.substr(prefix.size()) : text;
}

class Collector {
public:
  explicit Collector(const TopoDS_Shape& shape) : analyzer(shape) {}

  void collect(const TopoDS_Shape& shape, TopAbs_ShapeEnum type) {
    TopTools_IndexedMapOfShape parts;
    TopExp::MapShapes(shape, type, parts);
    for (int i = 1; i <= parts.Extent(); ++i) {
      const Handle(BRepCheck_Result) result = analyzer.Result(parts(i));
      if (!result.IsNull()) collect(*result, lower(TopAbs::ShapeTypeToString(type)) + " " + std::to_string(i - 1));
    }
  }

  bool valid() const { return analyzer.IsValid(); }
  std::vector<std::string> found;

private:
  void collect(BRepCheck_Result& result, const std::string& name) {
    add(result.Status(), name);
    for (result.InitContextIterator(); result.MoreShapeInContext(); result.NextShapeInContext())
      add(result.StatusOnShape(), name);
  }

  void add(const BRepCheck_ListOfStatus& statuses, const std::string& name) {
    for (const BRepCheck_Status status : statuses) {
      if (status == BRepCheck_NoError) continue;
      const std::string text = name + ": " + words(status);
      if (std::find(found.begin(), found.end(), text) == found.end()) found.push_back(text);
    }
  }

  BRepCheck_Analyzer analyzer;
};

}  // namespace

std::vector<std::string> faults(const TopoDS_Shape& shape) {
  Collector collector(shape);
  if (collector.valid()) return {};
  for (const auto type : {TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE, TopAbs_WIRE, TopAbs_EDGE, TopAbs_VERTEX})
    collector.collect(shape, type);
  if (collector.found.empty()) collector.found.push_back("invalid, for a reason BRepCheck does not tell");
  return collector.found;
}

}  // namespace softfold::occt
