#include "app/reference.h"
#include "sutura/text.h"

namespace sutura::app {

namespace {

std::string documentation(const std::string& text, const std::string& indent) {
  return indent + "<xs:annotation><xs:documentation>" + xml_escaped(text) +
         "</xs:documentation></xs:annotation>\n";
}

/// Types of attribute values. A schema cannot check units; the reader does.
const char* types = R"(  <xs:simpleType name="name">
    <xs:restriction base="xs:string"><xs:pattern value="[A-Za-z][A-Za-z0-9_\-]*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="real">
    <xs:annotation>
      <xs:documentation>A number with an optional unit: "30 kPa".</xs:documentation>
    </xs:annotation>
    <xs:restriction base="xs:string">
      <xs:pattern value="\s*[+\-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?\s*[^,;]*"/>
    </xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="reals">
    <xs:annotation>
      <xs:documentation>
        Numbers with an optional unit at the end that holds for all: "0 0 5 mm".
      </xs:documentation>
    </xs:annotation>
    <xs:restriction base="xs:string"><xs:pattern value="\s*[+\-]?[0-9.](.|\s)*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="integer">
    <xs:restriction base="xs:string"><xs:pattern value="-?[0-9]+"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="flag">
    <xs:restriction base="xs:string">
      <xs:enumeration value="true"/>
      <xs:enumeration value="false"/>
    </xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="path">
    <xs:annotation>
      <xs:documentation>Leads to a component: "/skin/tissue", "../tissue".</xs:documentation>
    </xs:annotation>
    <xs:restriction base="xs:string"><xs:minLength value="1"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="file">
    <xs:restriction base="xs:string"><xs:minLength value="1"/></xs:restriction>
  </xs:simpleType>
)";

const char* type_name(AttributeType type) {
  switch (type) {
    case AttributeType::real:
      return "real";
    case AttributeType::integer:
      return "integer";
    case AttributeType::flag:
      return "flag";
    case AttributeType::file:
      return "file";
    case AttributeType::vec3:
    case AttributeType::reals:
      return "reals";
    case AttributeType::text:
    case AttributeType::choice:
      break;
  }
  return "xs:string";
}

std::string attribute(const AttributeInfo& a) {
  std::string out = "      <xs:attribute name=\"" + a.name + "\"";
  const bool is_choice = a.type == AttributeType::choice;
  if (!is_choice) out += std::string(" type=\"") + type_name(a.type) + '"';
  if (a.is_required) out += " use=\"required\"";
  out += ">\n" + documentation(a.doc, "        ");
  if (is_choice) {
    out += "        <xs:simpleType><xs:restriction base=\"xs:string\">";
    for (const std::string& word : a.choices) out += "<xs:enumeration value=\"" + word + "\"/>";
    out += "</xs:restriction></xs:simpleType>\n";
  }
  return out + "      </xs:attribute>\n";
}

std::string element(const ComponentInfo& info) {
  std::string out = "  <xs:element name=\"" + info.name + "\">\n" +
                    documentation(info.summary, "    ") + "    <xs:complexType>\n";
  out += "      <xs:attribute name=\"name\" type=\"name\"/>\n";
  for (const AttributeInfo& a : info.attributes) out += attribute(a);
  for (const LinkInfo& l : info.links)
    out += "      <xs:attribute name=\"" + l.name + "\" type=\"path\">\n" +
           documentation(l.doc, "        ") + "      </xs:attribute>\n";
  return out + "    </xs:complexType>\n  </xs:element>\n";
}

}  // namespace

std::string xml_schema(const Registry& registry) {
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<xs:schema xmlns:xs=\"http://www.w3.org/2001/XMLSchema\">\n";
  out += types;
  out += "  <xs:group name=\"contents\">\n    <xs:choice>\n      <xs:element ref=\"node\"/>\n";
  for (const ComponentInfo* info : registry.components())
    out += "      <xs:element ref=\"" + info->name + "\"/>\n";
  out += R"(    </xs:choice>
  </xs:group>
  <xs:element name="sutura">
    <xs:complexType>
      <xs:choice minOccurs="0" maxOccurs="unbounded">
        <xs:element name="plugin">
          <xs:complexType>
            <xs:attribute name="name" type="xs:string" use="required"/>
          </xs:complexType>
        </xs:element>
        <xs:group ref="contents"/>
      </xs:choice>
      <xs:attribute name="version" use="required">
        <xs:simpleType>
          <xs:restriction base="xs:string"><xs:enumeration value="1"/></xs:restriction>
        </xs:simpleType>
      </xs:attribute>
      <xs:attribute name="dt" type="real"/>
      <xs:attribute name="gravity" type="reals"/>
      <xs:attribute name="duration" type="real"/>
      <xs:attribute name="tolerance" type="real"/>
      <xs:attribute name="gap_tolerance" type="real"/>
      <xs:attribute name="time_tolerance" type="real"/>
      <xs:attribute name="passes" type="real"/>
      <xs:attribute name="substeps" type="real"/>
      <xs:attribute name="time_order" type="real"/>
    </xs:complexType>
  </xs:element>
  <xs:element name="node">
    <xs:complexType>
      <xs:group ref="contents" minOccurs="0" maxOccurs="unbounded"/>
      <xs:attribute name="name" type="name" use="required"/>
    </xs:complexType>
  </xs:element>
)";
  for (const ComponentInfo* info : registry.components()) out += element(*info);
  return out + "</xs:schema>\n";
}

}  // namespace sutura::app
