#include "image_child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace camera_self_calibration {
namespace {

/// What comes through the pipe: this, then the text, then the pixels row by row.
struct Message {
  enum Kind : std::int32_t { kOpened, kImage, kUnreadable, kEnd, kFailed };
  Kind kind = kEnd;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int64_t number = 0;  ///< Stamp of an image [ns]; images of the source.
  std::uint64_t text_size = 0;
};

bool writeAll(int pipe, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t count = ::write(pipe, bytes, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

bool readAll(int pipe, void* data, std::size_t size) {
  auto* bytes = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t count = ::read(pipe, bytes, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

bool sendText(int pipe, Message message, const std::string& text) {
  message.text_size = text.size();
  return writeAll(pipe, &message, sizeof(message)) && writeAll(pipe, text.data(), text.size());
}

bool send(int pipe, const GrayImage& image) {
  Message message;
  message.kind = image.view ? Message::kImage : Message::kUnreadable;
  if (!image.view) return sendText(pipe, message, image.error);
  const ImageView& view = *image.view;
  message.width = view.width;
  message.height = view.height;
  message.number = view.stamp_ns;
  bool sent = writeAll(pipe, &message, sizeof(message));
  for (int y = 0; sent && y < view.height; ++y) {
    sent = writeAll(pipe, view.data + static_cast<std::ptrdiff_t>(y) * view.stride,
                    static_cast<std::size_t>(view.width));
  }
  return sent;
}

/// All that the child does.
void serve(const std::function<ImageSource()>& open, int pipe) {
  Message message;
  try {
    const ImageSource source = open();
    message.kind = Message::kOpened;
    message.number = source.count;
    bool heard = sendText(pipe, message, source.name + '\n' + source.description);
    while (heard) {
      const std::optional<GrayImage> image = source.next();
      if (!image) break;
      heard = send(pipe, *image);
    }
    message.kind = Message::kEnd;
    sendText(pipe, message, "");
  } catch (const std::exception& e) {
    message.kind = Message::kFailed;
    sendText(pipe, message, e.what());
  }
}

/// The parent's end of the pipe.
class ImageChild {
 public:
  ImageChild(const std::function<ImageSource()>& open, std::string crashed)
      : crashed_(std::move(crashed)) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail("a pipe cannot be made");
    child_ = ::fork();
    if (child_ == 0) {
      ::close(ends[0]);
      // Threads do not come along.
      cv::setNumThreads(1);
      serve(open, ends[1]);
      ::_exit(0);
    }
    ::close(ends[1]);
    pipe_ = ends[0];
    if (child_ < 0) {
      ::close(pipe_);
      fail("a process to read in cannot be started");
    }
  }
  ~ImageChild() {
    ::close(pipe_);
    ::kill(child_, SIGKILL);
    while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  ImageChild(const ImageChild&) = delete;
  ImageChild& operator=(const ImageChild&) = delete;

  /// The next message and its text; throws what the child threw, or `crashed`.
  Message receive(std::string* text) {
    Message message;
    if (!readAll(pipe_, &message, sizeof(message))) throw std::runtime_error(crashed_);
    text->resize(message.text_size);
    if (!readAll(pipe_, text->data(), text->size())) throw std::runtime_error(crashed_);
    if (message.kind == Message::kFailed) throw std::runtime_error(*text);
    return message;
  }

  std::optional<GrayImage> next() {
    if (ended_) return std::nullopt;
    std::string text;
    const Message message = receive(&text);
    ended_ = message.kind == Message::kEnd;
    if (ended_) return std::nullopt;
    if (message.kind == Message::kUnreadable) return GrayImage{std::nullopt, text};
    const auto pixels = std::make_shared<std::vector<std::uint8_t>>(
        static_cast<std::size_t>(message.width) * static_cast<std::size_t>(message.height));
    if (!readAll(pipe_, pixels->data(), pixels->size())) throw std::runtime_error(crashed_);
    return GrayImage{ImageView{pixels, pixels->data(), message.width, message.height, message.width,
                               message.number},
                     {}};
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
  }

  const std::string crashed_;
  int pipe_ = -1;
  pid_t child_ = -1;
  bool ended_ = false;
};

}  // namespace

ImageSource openInChild(const std::function<ImageSource()>& open, const std::string& crashed) {
  const auto child = std::make_shared<ImageChild>(open, crashed);
  std::string text;
  ImageSource source;
  source.count = child->receive(&text).number;
  const std::size_t end = text.find('\n');
  source.name = text.substr(0, end);
  source.description = text.substr(end + 1);
  source.next = [child] { return child->next(); };
  return source;
}

}  // namespace camera_self_calibration
