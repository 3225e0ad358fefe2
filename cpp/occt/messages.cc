#include "occt/messages.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPCAFControl_Controller.hxx>

#include <mutex>
#include <utility>

namespace softfold::occt {
namespace {

class Keeper : public Message_Printer {
  DEFINE_STANDARD_RTTI_INLINE(Keeper, Message_Printer)

public:
  std::string take() {
    const std::lock_guard<std::mutex> guard(mutex);
    return std::exchange(text, {});
  }

protected:
  void send(const TCollection_AsciiString& message, const Message_Gravity gravity) const override {
    constexpr std::size_t enough = 4096;  // nobody may ever ask for them
    if (gravity < Message_Warning) return;
    const std::lock_guard<std::mutex> guard(mutex);
    if (text.size() < enough) text += std::string(message.ToCString()) + "\n";
  }

private:
  mutable std::mutex mutex;
  mutable std::string text;
};

const Handle(Keeper) & keeper() {
  static const Handle(Keeper) single = new Keeper;
  return single;
}

}  // namespace

void start() {
  const Handle(Message_Messenger) messenger = Message::DefaultMessenger();
  messenger->ChangePrinters().Clear();
  messenger->AddPrinter(keeper());
  STEPCAFControl_Controller::Init();
}

std::string take_messages() { return keeper()->take(); }

}  // namespace softfold::occt
