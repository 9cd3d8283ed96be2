// ROS 2's bags as sqlite (rosbag2_storage_sqlite3): tables topics (id, name, type,
// serialization_format) and messages (id, topic_id, timestamp, data), read in the order of their
// rows, which is that in which they were written.

#include <sqlite3.h>

#include <map>

#include "calib/model/errors.h"
#include "services/bags/internal/bag_file.h"
#include "services/bags/internal/unpack.h"
#include "services/bags/printable.h"

namespace rgbdt::bags {
namespace {

// A prepared statement that is finalised with its owner.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& path, const char* text)
      : database_(database), path_(path) {
    if (sqlite3_prepare_v2(database, text, -1, &statement_, nullptr) != SQLITE_OK) Fail();
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void Bind(std::int64_t value) {
    sqlite3_reset(statement_);
    sqlite3_bind_int64(statement_, 1, value);
  }
  bool Step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) Fail();
    return code == SQLITE_ROW;
  }
  std::int64_t Integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string Text(int column) const {
    const unsigned char* text = sqlite3_column_text(statement_, column);
    return text == nullptr ? "" : reinterpret_cast<const char*>(text);
  }
  const std::uint8_t* Blob(int column, std::size_t* size) const {
    const void* blob = sqlite3_column_blob(statement_, column);
    *size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return static_cast<const std::uint8_t*>(blob);
  }

 private:
  [[noreturn]] void Fail() const {
    throw InputError(path_ + ": " + Printable(sqlite3_errmsg(database_)));
  }

  sqlite3* database_;
  const std::string& path_;
  sqlite3_stmt* statement_ = nullptr;
};

constexpr char kColumns[] = "SELECT id, topic_id, timestamp, data FROM messages";

class SqliteReader : public BagReader {
 public:
  explicit SqliteReader(const std::filesystem::path& path) : file_(path), budget_(file_.size()) {
    Open();
    ReadTopics();
    CountRows();
    rows_ = std::make_unique<Statement>(database_.get(), file_.path(),
                                        (std::string(kColumns) + " ORDER BY id").c_str());
    row_ = std::make_unique<Statement>(database_.get(), file_.path(),
                                       (std::string(kColumns) + " WHERE id = ?").c_str());
  }

  bool Next(BagMessage* message) override {
    while (!done_) {
      try {
        done_ = !rows_->Step();
        if (done_) break;
        ++read_rows_;
        *message = MessageOf(*rows_, &budget_);
        return true;
      } catch (const InputError& error) {
        problems_.Add(std::string(error.what()) + " (row " + std::to_string(read_rows_) + ")");
        done_ = sqlite3_errcode(database_.get()) != SQLITE_ROW;
      }
    }
    return false;
  }

  BagMessage Read(const BagPlace& place) override {
    row_->Bind(place.at);
    if (!row_->Step()) throw InputError(file_.path() + ": has changed while it was read");
    return MessageOf(*row_, nullptr);
  }

  void Rest() override { unpacked_ = {}; }
  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  const std::vector<std::string>& problems() const override { return problems_.lines(); }
  std::int64_t position() const override {
    return count_ == 0 ? file_.size()
                       : static_cast<std::int64_t>(static_cast<double>(file_.size()) *
                                                   static_cast<double>(read_rows_) /
                                                   static_cast<double>(count_));
  }
  std::int64_t size() const override { return file_.size(); }
  std::string format() const override { return "ROS 2 bag (sqlite)"; }

 private:
  void Open() {
    sqlite3* database = nullptr;
    const int code =
        sqlite3_open_v2(file_.path().c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(database);
    if (code != SQLITE_OK) throw InputError(file_.path() + ": " + sqlite3_errstr(code));
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMostBagBytes));
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    // A forged file could have views of the same names, which compute for ever.
    Statement tables(database, file_.path(),
                     "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND "
                     "name IN ('topics', 'messages')");
    if (!tables.Step() || tables.Integer(0) != 2) {
      throw InputError(file_.path() +
                       ": is a sqlite file but no ROS 2 bag; expected tables topics and messages");
    }
  }

  void ReadTopics() {
    Statement rows(database_.get(), file_.path(),
                   "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (rows.Step()) {
      const BagEncoding encoding = rows.Text(3) == "cdr" ? BagEncoding::kCdr : BagEncoding::kOther;
      topic_of_[rows.Integer(0)] = topics_.Add(rows.Text(1), rows.Text(2), encoding);
    }
  }

  // By the ends of the index: to count them all is to read the file.
  void CountRows() {
    Statement rows(database_.get(), file_.path(), "SELECT min(id), max(id) FROM messages");
    if (rows.Step()) count_ = rows.Integer(1) - rows.Integer(0) + 1;
  }

  // What it costs to unpack it is counted the first time.
  BagMessage MessageOf(const Statement& row, UnpackBudget* budget) {
    BagMessage message;
    message.place = {0, row.Integer(0), -1};
    const auto topic = topic_of_.find(row.Integer(1));
    if (topic == topic_of_.end()) {
      throw InputError(file_.path() + ": a message is of topic " + std::to_string(row.Integer(1)) +
                       ", which the table topics does not have");
    }
    message.topic = topic->second;
    message.log_utime = row.Integer(2) / 1000;
    message.data = row.Blob(3, &message.size);
    // `ros2 bag record --compression-mode message`: no CDR begins as zstd does.
    if (IsZstd(message.data, message.size)) {
      const std::uint64_t unpacked = ZstdSize(message.data, message.size);
      if (budget != nullptr) budget->Spend(unpacked);
      Unpack("zstd", message.data, message.size, unpacked, &unpacked_);
      message.data = unpacked_.data();
      message.size = unpacked_.size();
    }
    return message;
  }

  BagFile file_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, sqlite3_close};
  std::unique_ptr<Statement> rows_, row_;  // go before the database
  std::map<std::int64_t, std::size_t> topic_of_;
  std::int64_t count_ = 0, read_rows_ = 0;
  UnpackBudget budget_;
  bool done_ = false;
  std::vector<std::uint8_t> unpacked_;
  TopicList topics_;
  Problems problems_;
};

}  // namespace

std::unique_ptr<BagReader> OpenSqlite(const std::filesystem::path& path) {
  return std::make_unique<SqliteReader>(path);
}

}  // namespace rgbdt::bags
